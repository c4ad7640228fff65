# SPDX-License-Identifier: GPL-3.0-or-later
"""A whole Blender looks up the extension's texts among the translations that it is given."""

import shutil

from german_texts import LANGUAGE, TEXTS

ENGLISH = {
    "panel": "Muscles on ",
    "grey button": "CLIP has no performance: press ",
    "error": "frame 5000: CLIP has frames 1 to ",
    "report": " frames/s",
}
GERMAN = {
    "panel": "Muskeln an ",
    "grey button": "oder Darbietung laden: CLIP hat keine",
    "error": "Bilder, nicht 5000",
    "report": " Bilder/s, ",
}


def test_texts_are_shown_in_blenders_language(folder, screen, extension, clip, work, pictures):
    for path in (extension, clip):
        shutil.copy(path, work)
    settings = {
        "extension": extension.name,
        "clip": clip.name,
        "language": LANGUAGE,
        "texts": [[context, text, other] for (context, text), other in TEXTS.items()],
        "english": ENGLISH,
        "german": GERMAN,
    }
    result = folder.walk(screen, "walk_translations.py", work, pictures, settings, seconds=200)
    assert not result.failures()
