# SPDX-License-Identifier: GPL-3.0-or-later
"""Networks for eyes and mouth that tests of this folder share."""

import pytest
from mimetic.locate.feature_networks import installed_networks


@pytest.fixture(scope="module")
def networks():
    networks = installed_networks()
    if networks is None:
        pytest.skip("scripts/make_networks was not run")
    return networks
