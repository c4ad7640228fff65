// SPDX-License-Identifier: GPL-3.0-or-later
#include "locate/measure.hpp"

namespace mimetic::locate {

Expected average_face() {
    Expected expected;
    const auto pair = [&](const std::string& name, double x, double y) {
        expected.features[name + ".L"] = {x, y};
        expected.features[name + ".R"] = {-x, y};
    };
    pair("pupil", 0.5, 0);
    pair("brow_inner", 0.26, -0.29);
    pair("brow_middle", 0.50, -0.40);
    pair("brow_outer", 0.80, -0.30);
    pair("nostril", 0.13, 0.74);
    pair("ala", 0.29, 0.68);
    pair("mouth_corner", 0.40, 1.15);
    expected.features["lip_line"] = {0, 1.13};
    expected.features["lip_upper"] = {0, 1.00};
    expected.features["lip_lower"] = {0, 1.30};
    Points2 jaw(9, 2);  // from the subject's left, so that the normals point out of the face
    jaw << 1.08, 0.76, 1.04, 1.00, 0.92, 1.30, 0.58, 1.66, 0, 1.84, -0.58, 1.66, -0.92, 1.30, -1.04, 1.00,
        -1.08, 0.76;
    expected.curves["jaw"] = jaw;
    expected.search = 0.2;
    return expected;
}

}  // namespace mimetic::locate
