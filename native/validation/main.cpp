// SPDX-License-Identifier: GPL-3.0-or-later
// Prints the skin's validation as a table. Ends with 1 if a case is off its limit at the stated mesh or does
// not converge monotonically, with 2 if called wrongly.
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>

#include "table.hpp"

namespace mimetic::validation {
namespace {

/// Whole or not at all.
bool write_file(const std::string& path, const std::string& text) {
    const std::string aside = path + ".part";
    std::ofstream file(aside, std::ios::binary);
    file << text;
    file.close();
    std::error_code error;
    if (file) {
        std::filesystem::rename(aside, path, error);
    }
    return file && !error;
}

int run_all(const std::string& csv_path) {
    int num_cases = 0;
    int num_failed = 0;
    std::ostringstream csv;
    write_csv_header(csv);
    write_header(std::cout);
    for (const auto& benchmarks : {element_benchmarks, membrane_benchmarks, foundation_benchmarks,
                                   plate_benchmarks, shell_benchmarks}) {
        for (const Benchmark& benchmark : benchmarks()) {
            std::vector<double> values;
            values.reserve(benchmark.meshes.size());
            for (int mesh : benchmark.meshes) {
                values.push_back(benchmark.value(mesh));
            }
            const Outcome outcome = judge(benchmark, values);
            write_row(std::cout, benchmark, outcome);
            write_csv(csv, benchmark, outcome);
            ++num_cases;
            num_failed += outcome.passed() ? 0 : 1;
        }
    }
    if (!csv_path.empty() && !write_file(csv_path, csv.str())) {
        std::cerr << "validate_skin: cannot write " << csv_path << '\n';
        return 2;
    }
    std::cerr << num_cases << " cases, " << num_failed << " failed\n";
    return num_failed == 0 ? 0 : 1;
}

}  // namespace
}  // namespace mimetic::validation

int main(int argc, char** argv) {
    const bool with_csv = argc == 3 && std::string(argv[1]) == "--csv";
    if (argc != 1 && !with_csv) {
        std::cerr << "usage: validate_skin [--csv FILE]\n";
        return 2;
    }
    try {
        return mimetic::validation::run_all(with_csv ? argv[2] : "");
    } catch (const std::exception& error) {
        std::cerr << "validate_skin: " << error.what() << '\n';
        return 1;
    }
}
