# SPDX-License-Identifier: GPL-3.0-or-later
add_library(mimetic_warnings INTERFACE)
target_compile_options(mimetic_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Werror)
if(CMAKE_COMPILER_IS_GNUCXX)
    # GCC 12 sees uninitialised reads inside Eigen's own headers at -O3 that are not there.
    target_compile_options(mimetic_warnings INTERFACE -Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overread)
endif()
if(MIMETIC_SANITIZE)
    add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
    add_link_options(-fsanitize=address,undefined)
    # Under the sanitizer Eigen would align by hand and could not share memory with the packaged Ceres.
    add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()
