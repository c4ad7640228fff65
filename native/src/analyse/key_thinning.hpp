// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <mimetic/shared/types.hpp>
#include <set>

namespace mimetic {

/// Takes keys away, and moves others a little, as long as the curve stays within `tolerance` of the dense
/// one: they were added one at a time where the error was largest, and later ones may do without earlier
/// ones. rows: those that have a key, the first and the last among them; those of `fixed` stay, as those
/// do between which the curve rests.
void thin_out(VectorIn frames, VectorIn values, double tolerance, std::set<int>& rows,
              const std::set<int>& fixed);

}  // namespace mimetic
