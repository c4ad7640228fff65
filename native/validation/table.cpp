// SPDX-License-Identifier: GPL-3.0-or-later
#include "table.hpp"

#include <iomanip>
#include <sstream>

namespace mimetic::validation {
namespace {

std::string digits(double value, int count = 4) {
    std::ostringstream text;
    text << std::setprecision(count) << value;
    return text.str();
}

const char* element_name(Element element) { return element == Element::skin ? "skin" : "CST + DKT"; }

const char* moves_face(Element element) { return element == Element::skin ? "yes" : "no"; }

/// Errors at rounding differ from machine to machine: their size is enough.
std::string value_text(const Benchmark& benchmark, double value) {
    if (benchmark.reference != 0) {
        return digits(value);
    }
    return std::abs(value) < 1e-12 ? "< 1e-12" : digits(value, 1);
}

std::string error_text(const Benchmark& benchmark, const Outcome& outcome) {
    if (benchmark.reference == 0) {
        return value_text(benchmark, outcome.stated_error);
    }
    std::ostringstream text;
    text << std::fixed << std::setprecision(2) << std::showpos << 100 * outcome.stated_error + 0.0 << " %";
    return text.str();
}

}  // namespace

void write_header(std::ostream& out) {
    out << "| case | element | moves the face | quantity | values at n | reference | source | error | limit "
           "| verdict |\n"
        << "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
}

void write_row(std::ostream& out, const Benchmark& b, const Outcome& outcome) {
    out << "| " << b.title << " | " << element_name(b.element) << " | " << moves_face(b.element) << " | "
        << b.quantity << " | ";
    for (std::size_t i = 0; i < b.meshes.size(); ++i) {
        const char* mark = b.meshes[i] == b.stated_mesh ? "**" : "";
        out << (i > 0 ? ", " : "") << mark << b.meshes[i] << ": " << value_text(b, outcome.values[i]) << mark;
    }
    out << " | " << digits(b.reference, 5) << " | " << b.source << " | " << error_text(b, outcome) << " | ";
    out << (b.limit < 1e-6 ? digits(b.limit) : digits(100 * b.limit) + " %") << " | ";
    out << (!outcome.is_within ? "OFF" : outcome.is_monotone ? "holds" : "NOT MONOTONE") << " |\n";
}

void write_csv_header(std::ostream& out) {
    out << "name,title,element,n,value,reference,error,stated_n,limit\n";
}

void write_csv(std::ostream& out, const Benchmark& b, const Outcome& outcome) {
    for (std::size_t i = 0; i < b.meshes.size(); ++i) {
        out << b.name << ",\"" << b.title << "\"," << element_name(b.element) << ',' << b.meshes[i] << ','
            << digits(outcome.values[i], 8) << ',' << digits(b.reference, 8) << ','
            << digits(outcome.errors[i], 8) << ',' << b.stated_mesh << ',' << b.limit << '\n';
    }
}

}  // namespace mimetic::validation
