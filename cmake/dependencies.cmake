# SPDX-License-Identifier: GPL-3.0-or-later
# Debian 12's packages: libeigen3-dev 3.4, libopencv-*-dev 4.6, libosd-dev 3.5, libceres-dev 2.1, libsuitesparse-dev 5.12,
# libspectra-dev 1.0.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)

# Apache-2.0. Named one by one: the package's config file asks for modules that we do not use.
find_path(OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4 REQUIRED)
add_library(mimetic_opencv INTERFACE)
target_include_directories(mimetic_opencv SYSTEM INTERFACE ${OPENCV_INCLUDE_DIR})
foreach(module objdetect dnn video imgproc core)
    find_library(OPENCV_${module} opencv_${module} REQUIRED)
    target_link_libraries(mimetic_opencv INTERFACE ${OPENCV_${module}})
endforeach()

# Modified Apache-2.0
find_path(OPENSUBDIV_INCLUDE_DIR opensubdiv/far/topologyRefiner.h REQUIRED)
find_library(OPENSUBDIV_LIBRARY osdCPU REQUIRED)
add_library(mimetic_opensubdiv INTERFACE)
target_include_directories(mimetic_opensubdiv SYSTEM INTERFACE ${OPENSUBDIV_INCLUDE_DIR})
target_link_libraries(mimetic_opensubdiv INTERFACE ${OPENSUBDIV_LIBRARY})

# BSD-3-Clause
find_package(Ceres 2.1 REQUIRED)
add_library(mimetic_ceres INTERFACE)
target_link_libraries(mimetic_ceres INTERFACE Ceres::ceres)

# CHOLMOD: LGPL-2.1+ and GPL-2+
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
add_library(mimetic_cholmod INTERFACE)
target_include_directories(mimetic_cholmod SYSTEM INTERFACE ${CHOLMOD_INCLUDE_DIR})
target_link_libraries(mimetic_cholmod INTERFACE ${CHOLMOD_LIBRARY})

# MPL-2.0, headers alone
find_path(SPECTRA_INCLUDE_DIR Spectra/SymGEigsShiftSolver.h REQUIRED)
add_library(mimetic_spectra INTERFACE)
target_include_directories(mimetic_spectra SYSTEM INTERFACE ${SPECTRA_INCLUDE_DIR})
