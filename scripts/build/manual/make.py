# SPDX-License-Identifier: GPL-3.0-or-later
"""Write the pages of the manual that say what the program says; --messages: what its page lacks."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import commands_page
import messages
import panels_page

GUIDE = Path(__file__).resolve().parents[3] / "docs" / "guide"
WRITTEN = {"commands.md": commands_page.page, "panels.md": panels_page.page}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--messages", action="store_true", help="say what messages.md lacks")
    if parser.parse_args().messages:
        return compare_messages()
    for name, page in WRITTEN.items():
        (GUIDE / name).write_text(page(), encoding="utf-8")
        print(f"docs/guide/{name} is written")
    return 0


def compare_messages() -> int:
    text = (GUIDE / "messages.md").read_text(encoding="utf-8")
    missing, unused = messages.missing(text), messages.unused(text)
    for message in missing:
        print(f"missing  {message.source}: {message.text}")
    for pattern in unused:
        print(f"unused   {pattern}")
    print(f"{len(missing)} messages are not on the page, {len(unused)} of its own are no message")
    return 1 if missing or unused else 0


if __name__ == "__main__":
    sys.exit(main())
