// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <exception>
#include <stdexcept>

namespace mimetic {

/// An invalid argument; the text says what, where and what to do. ValueError in Python.
class InvalidInput : public std::invalid_argument {
public:
    using std::invalid_argument::invalid_argument;
};

/// A file that cannot be read as what it should be. OSError in Python.
class UnreadableMedia : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Whether OpenCV says by it that memory does not suffice: it throws no std::bad_alloc. MemoryError in
/// Python.
bool says_no_memory(const std::exception& error);

}  // namespace mimetic
