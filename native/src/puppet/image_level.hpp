// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <mimetic/shared/image.hpp>
#include <vector>

namespace mimetic::puppet {

/// Positions x0 <= x < x1, y0 <= y < y1.
struct Window {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    bool is_empty() const { return x1 <= x0 || y1 <= y0; }
    Window united(const Window& other) const;
    Window intersected(const Window& other) const;
};

/// One size of an image, with what all templates share: grey values ready to be multiplied, and sums of
/// values and squares over windows. Sums wrap around at 2^32 and their differences are exact, as long as a
/// window has at most 16384 pixels.
class ImageLevel {
public:
    static constexpr int kPadding = 16;  ///< zeros after each row, so that wide reads stay inside

    void load(const GrayView& image);
    void load_half(
        const ImageLevel& larger);  ///< blurred, every other pixel; of an odd side the last is left out

    /// Sums over the pixels of an area, for windows inside of it.
    void sum(const Window& area);

    int rows() const { return rows_; }
    int cols() const { return cols_; }
    const std::int16_t* row(int y) const { return values_.data() + y * stride_; }
    std::ptrdiff_t stride() const { return stride_; }

    /// Whether there are sums for rows x cols pixels from each of these positions.
    bool covers(const Window& positions, int rows, int cols) const {
        return positions.x0 >= area_.x0 && positions.y0 >= area_.y0 && positions.x1 + cols - 1 <= area_.x1 &&
               positions.y1 + rows - 1 <= area_.y1;
    }

    /// Over rows x cols pixels from x, y; inside of the area given to `sum`.
    std::uint32_t sum_of(int x, int y, int rows, int cols) const { return box(sums_, x, y, rows, cols); }
    std::uint32_t squares_of(int x, int y, int rows, int cols) const {
        return box(squares_, x, y, rows, cols);
    }

private:
    std::uint32_t box(const std::vector<std::uint32_t>& table, int x, int y, int rows, int cols) const {
        const std::size_t width = static_cast<std::size_t>(area_.x1 - area_.x0) + 1;
        const std::uint32_t* top = table.data() + static_cast<std::size_t>(y - area_.y0) * width;
        const std::uint32_t* bottom = top + static_cast<std::size_t>(rows) * width;
        const std::ptrdiff_t left = x - area_.x0, right = left + cols;
        return bottom[right] - bottom[left] - top[right] + top[left];
    }

    void resize(int rows, int cols);

    int rows_ = 0, cols_ = 0;
    std::ptrdiff_t stride_ = 0;
    std::vector<std::int16_t> values_;
    Window area_;
    std::vector<std::uint32_t> sums_, squares_;  // (rows + 1) x (cols + 1) of the area
};

}  // namespace mimetic::puppet
