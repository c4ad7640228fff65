# SPDX-License-Identifier: GPL-3.0-or-later
"""A translation of a few texts, as someone would register it, by context and English."""

LANGUAGE = "de_DE"
TEXTS = {
    ("*", "Muscles on {name}:"): "Muskeln an {name}:",
    ("*", "a head of your own"): "einem eigenen Kopf",
    ("*", "Load the footage first (Load Clip)"): "Zuerst den Film laden (Clip laden)",
    ("*", "{clip} has no performance: press {buttons}, or Load Performance, first"): (
        "Zuerst {buttons} oder Darbietung laden: {clip} hat keine"
    ),
    ("*", "{clip}: {width} x {height}, {fps:.6g} frames/s"): (
        "{fps:.6g} Bilder/s, {width} mal {height}: {clip}"
    ),
    ("*", "frame {frame}: {clip} has frames 1 to {last}"): (
        "{clip} hat {last} Bilder, nicht {frame}"
    ),
    (
        "*",
        "Frame {frame} is taken as rest: the face looks most at rest there, and {alike} of the "
        "{seen} frames looked at show this expression",
    ): "Ruhe ist Bild {frame}: {alike} von {seen} Bildern zeigen diesen Ausdruck",
    ("*", "{job} is running; Esc stops it"): "{job} läuft; Esc beendet es",
    ("Operator", "Capture"): "Aufnehmen",
}
