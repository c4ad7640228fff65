# SPDX-License-Identifier: GPL-3.0-or-later
"""Muscles of the face units' action units, and whole expressions.

By FACS (Ekman and Friesen), as far as our muscles have a counterpart: none for the dimpler
(buccinator), the sideways mouth and the raised upper lip of `mouthShrugUpper`. A name without .L
or .R, Left or Right stands for both sides.
"""

from __future__ import annotations

UNIT_MUSCLES: dict[str, dict[str, float]] = {
    "browInnerUp": {"frontalis_medial": 1},
    "browOuterUp": {"frontalis_lateral": 1, "frontalis_middle": 1},
    "browDown": {"corrugator_supercilii": 1, "depressor_supercilii": 1, "procerus": 1},
    "eyeWide": {"lid_upper": -0.4},
    "eyeBlink": {"lid_upper": 1},
    "cheekSquint": {"orbicularis_oculi_inferior": 1},
    "eyeSquint": {"orbicularis_oculi_lateral": 1, "lid_lower": 1, "lid_upper": 0.2},
    "noseSneer": {"levator_labii_superioris_alaeque_nasi": 1, "procerus": 1},
    "mouthUpperUp": {"levator_labii_superioris": 1},
    "mouthSmile": {"zygomaticus_major": 1},
    "mouthFrown": {"depressor_anguli_oris": 1},
    "mouthLowerDown": {"depressor_labii_inferioris": 1},
    "mouthShrugLower": {"mentalis": 1},
    "mouthPucker": {
        "orbicularis_oris": 1,
        "oris_protrude_upper": 0.5,
        "oris_protrude_lower": 0.5,
    },
    "mouthStretch": {"risorius": 1},
    "mouthFunnel": {
        "orbicularis_oris": 0.5,
        "oris_protrude_upper": 0.5,
        "oris_protrude_lower": 0.5,
        "lip_roll_upper": 1,
        "lip_roll_lower": 1,
    },
    "mouthPress": {"oris_close_upper": 1, "oris_close_lower": 1},
    "mouthRollUpper": {"lip_roll_upper": -1, "oris_close_upper": 0.5},
    "mouthRollLower": {"lip_roll_lower": -1, "oris_close_lower": 0.5},
    "cheekPuff": {"air_cheek": 1, "air_lips": 0.5},
    "jawOpen": {"jaw_open": 1},
    "jawForward": {"jaw_thrust": 1},
    "jawLeft": {"jaw_side": 1},
}

# Sums of face units: truth for whole expressions. The seven basic emotions by their action units
# (Ekman and Friesen), smile and open smile for happiness, and three of the lips. None is a unit by
# itself: a blink is one, and counts among the units.
COMPOSITES: dict[str, dict[str, float]] = {
    "smile": {"mouthSmile": 0.8, "cheekSquint": 0.7},
    "open smile": {"mouthSmile": 0.9, "cheekSquint": 0.8, "jawOpen": 0.3, "mouthUpperUp": 0.4},
    "sadness": {"browInnerUp": 0.9, "browDown": 0.3, "mouthFrown": 0.8, "mouthShrugLower": 0.4},
    "surprise": {"browInnerUp": 0.9, "browOuterUp": 0.9, "eyeWide": 0.8, "jawOpen": 0.6},
    "anger": {"browDown": 0.9, "eyeSquint": 0.5, "mouthPress": 0.7, "noseSneer": 0.3},
    "disgust": {"noseSneer": 0.9, "mouthUpperUp": 0.6, "browDown": 0.4, "mouthFrown": 0.4},
    "fear": {
        "browInnerUp": 0.9,
        "browOuterUp": 0.6,
        "browDown": 0.3,
        "eyeWide": 0.8,
        "mouthStretch": 0.8,
        "jawOpen": 0.2,
    },
    "contempt": {"mouthSmileLeft": 0.4, "mouthDimpleLeft": 0.7},  # of one side: 12 + 14
    "pucker": {"mouthPucker": 0.9, "mouthShrugLower": 0.3},  # 18 + 17
    "pout": {"mouthShrugLower": 0.9, "mouthShrugUpper": 0.5, "mouthPucker": 0.3},
    "speech, o": {"jawOpen": 0.3, "mouthFunnel": 0.7, "mouthPucker": 0.3},
}

# The basic emotions and a pucker by our muscles, after the action units given with each.
EXPRESSIONS: dict[str, dict[str, float]] = {
    "smile": {  # 6 + 12
        "zygomaticus_major": 1.0,
        "zygomaticus_minor": 0.2,
        "orbicularis_oculi_inferior": 0.7,
        "orbicularis_oculi_lateral": 0.4,
        "lid_lower": 0.4,
    },
    "sadness": {  # 1 + 4 + 15 + 17
        "frontalis_medial": 0.9,
        "corrugator_supercilii": 0.5,
        "depressor_anguli_oris": 0.8,
        "mentalis": 0.4,
        "lid_upper": 0.2,
    },
    "surprise": {  # 1 + 2 + 5 + 26
        "frontalis_medial": 0.9,
        "frontalis_middle": 0.9,
        "frontalis_lateral": 0.9,
        "lid_upper": -0.4,
        "jaw_open": 0.6,
    },
    "anger": {  # 4 + 5 + 7 + 23
        "corrugator_supercilii": 1.0,
        "depressor_supercilii": 0.7,
        "procerus": 0.5,
        "orbicularis_oculi_lateral": 0.3,
        "lid_upper": -0.2,
        "lid_lower": 0.4,
        "oris_close_upper": 0.6,
        "oris_close_lower": 0.6,
        "depressor_anguli_oris": 0.2,
    },
    "disgust": {  # 9 + 10 + 15 + 17
        "levator_labii_superioris_alaeque_nasi": 1.0,
        "levator_labii_superioris": 0.5,
        "procerus": 0.5,
        "corrugator_supercilii": 0.4,
        "orbicularis_oculi_inferior": 0.4,
        "depressor_anguli_oris": 0.4,
        "mentalis": 0.4,
        "lid_lower": 0.4,
    },
    "fear": {  # 1 + 2 + 4 + 5 + 20 + 26
        "frontalis_medial": 0.9,
        "frontalis_middle": 0.6,
        "frontalis_lateral": 0.4,
        "corrugator_supercilii": 0.6,
        "lid_upper": -0.4,
        "risorius": 0.7,
        "depressor_labii_inferioris": 0.3,
        "jaw_open": 0.25,
    },
    "pucker": {  # 18; the ring alone brings the lower lip further forward than the upper
        "orbicularis_oris": 1.0,
        "oris_protrude_upper": 0.8,
        "oris_protrude_lower": 0.2,
    },
}
