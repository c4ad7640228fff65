// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <ostream>

#include "outcome.hpp"

namespace mimetic::validation {

/// Markdown.
void write_header(std::ostream& out);
void write_row(std::ostream& out, const Benchmark& benchmark, const Outcome& outcome);

/// Comma-separated values, a line a mesh.
void write_csv_header(std::ostream& out);
void write_csv(std::ostream& out, const Benchmark& benchmark, const Outcome& outcome);

}  // namespace mimetic::validation
