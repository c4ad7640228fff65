// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace mimetic {

/// Lets the environment's OPENCV_FOR_THREADS_NUM limit the threads that work in parallel, as OpenCV itself
/// does unless it was built with TBB, as Debian's is. What is no number from 1 to 1024 changes nothing.
///
/// Results do not depend on the number of threads, nor of cores: where one thread works OpenCV is told of
/// two, as its networks round otherwise where they know of one.
void follow_thread_limit();

}  // namespace mimetic
