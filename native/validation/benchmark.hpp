// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace mimetic::validation {

/// What of the core computes a case.
enum class Element {
    skin,   ///< SkinModel: three unknowns a vertex, what moves the face
    plate,  ///< ShellModel: six unknowns a vertex; no face has it
};

/// One published or closed-form case, computed on finer and finer meshes.
struct Benchmark {
    std::string name;   ///< one word for files: scordelis_lo
    std::string title;  ///< "Scordelis-Lo roof"
    Element element = Element::skin;
    std::string quantity;  ///< what is compared, with its unit
    double reference = 0;  ///< 0: the value is an error itself, and `limit` is absolute
    std::string source;
    std::vector<int> meshes;  ///< elements along a side, rising
    int stated_mesh = 0;      ///< the one that must be within `limit`
    double limit = 0.03;      ///< of the reference
    std::function<double(int mesh)> value;
};

std::vector<Benchmark> element_benchmarks();     // patch tests, rigid motion, energy
std::vector<Benchmark> membrane_benchmarks();    // Cook, drum
std::vector<Benchmark> foundation_benchmarks();  // decay, single pull
std::vector<Benchmark> plate_benchmarks();       // square plates, cantilever
std::vector<Benchmark> shell_benchmarks();       // the obstacle course

}  // namespace mimetic::validation
