# SPDX-License-Identifier: GPL-3.0-or-later
"""The option `--send` of commands that drive a face."""

from __future__ import annotations

import argparse

from mimetic.puppet.receiver import parse_address


def add_send(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--send",
        action="append",
        default=[],
        metavar="ADDRESS",
        help="send each state to a program: osc://HOST:PORT (VMC) or livelink://HOST:PORT; "
        "may be given again. Nothing is received",
    )


def addresses_of(arguments: argparse.Namespace) -> tuple[str, ...]:
    """Raises InvalidInput."""
    for address in arguments.send:
        parse_address(address)
    return tuple(arguments.send)
