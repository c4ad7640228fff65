// SPDX-License-Identifier: GPL-3.0-or-later
#include "image_level.hpp"

#include <algorithm>

namespace mimetic::puppet {

Window Window::united(const Window& other) const {
    if (is_empty()) {
        return other;
    }
    if (other.is_empty()) {
        return *this;
    }
    return {std::min(x0, other.x0), std::min(y0, other.y0), std::max(x1, other.x1), std::max(y1, other.y1)};
}

Window Window::intersected(const Window& other) const {
    return {std::max(x0, other.x0), std::max(y0, other.y0), std::min(x1, other.x1), std::min(y1, other.y1)};
}

void ImageLevel::resize(int rows, int cols) {
    if (rows == rows_ && cols == cols_) {
        return;
    }
    rows_ = rows;
    cols_ = cols;
    stride_ = cols + kPadding;
    values_.assign(static_cast<std::size_t>(stride_ * rows), 0);
}

void ImageLevel::load(const GrayView& image) {
    resize(image.rows, image.cols);
    for (int y = 0; y < rows_; ++y) {
        std::copy_n(image.row(y), cols_, values_.data() + y * stride_);
    }
}

void ImageLevel::load_half(const ImageLevel& larger) {
    resize(larger.rows_ / 2, larger.cols_ / 2);
    // 1 3 3 1 along both axes: with plain means a part that moves by a pixel would look different
    std::vector<std::int16_t> blurred(static_cast<std::size_t>(larger.cols_) + 2);
    const int last = larger.rows_ - 1;
    for (int y = 0; y < rows_; ++y) {
        const std::int16_t* a = larger.row(std::max(2 * y - 1, 0));
        const std::int16_t* b = larger.row(2 * y);
        const std::int16_t* c = larger.row(2 * y + 1);
        const std::int16_t* d = larger.row(std::min(2 * y + 2, last));
        for (int x = 0; x < larger.cols_; ++x) {
            blurred[static_cast<std::size_t>(x) + 1] =
                static_cast<std::int16_t>(a[x] + 3 * (b[x] + c[x]) + d[x]);
        }
        blurred.front() = blurred[1];
        blurred.back() = blurred[blurred.size() - 2];
        const std::int16_t* from = blurred.data();
        std::int16_t* to = values_.data() + y * stride_;
        for (int x = 0; x < cols_; ++x, from += 2) {
            to[x] = static_cast<std::int16_t>((from[0] + 3 * (from[1] + from[2]) + from[3] + 32) >> 6);
        }
    }
}

void ImageLevel::sum(const Window& area) {
    area_ = area;
    const int cols = area.x1 - area.x0, rows = area.y1 - area.y0;
    const std::size_t width = static_cast<std::size_t>(cols) + 1;
    const std::size_t size = width * (static_cast<std::size_t>(rows) + 1);
    if (sums_.size() < size) {
        sums_.resize(size);
        squares_.resize(size);
    }
    std::fill_n(sums_.begin(), width, 0U);
    std::fill_n(squares_.begin(), width, 0U);
    for (int y = 0; y < rows; ++y) {
        const std::int16_t* from = row(area.y0 + y) + area.x0;
        const std::size_t above = static_cast<std::size_t>(y) * width, at = above + width;
        std::uint32_t sum = 0, square = 0;
        sums_[at] = squares_[at] = 0;
        for (std::size_t x = 0; x < static_cast<std::size_t>(cols); ++x) {
            const auto value = static_cast<std::uint32_t>(from[x]);
            sum += value;
            square += value * value;
            sums_[at + x + 1] = sums_[above + x + 1] + sum;
            squares_[at + x + 1] = squares_[above + x + 1] + square;
        }
    }
}

}  // namespace mimetic::puppet
