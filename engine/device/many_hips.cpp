#include "engine/device/many_hips.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "engine/base/processor.hpp"
#include "engine/math/elementary.hpp"

namespace palpate::engine {
namespace {

/// Readings that are worked on at once: their sines and cosines stay in the first cache.
constexpr std::size_t kAtOnce = 256;
using Numbers = std::array<double, kAtOnce>;

struct Directions {
    Numbers sin;
    Numbers cos;
};

}  // namespace

/// Written so that compilers turn each loop into vector instructions, which give every number the
/// same bits as the plain ones.
struct ManyHips::Loops {
    [[gnu::always_inline]] static void turn(double zero,
                                            double count,
                                            std::span<const Counts> counts,
                                            std::size_t axis,
                                            Directions& out) noexcept {
        for (std::size_t i = 0; i < counts.size(); ++i) {
            const SinCos direction = near_sin_cos(zero + counts[i][axis] * count);
            out.sin[i] = direction.sin;
            out.cos[i] = direction.cos;
        }
    }

    [[gnu::always_inline]] static void place(const ManyHips& machine,
                                             std::span<const Counts> counts,
                                             std::span<Vec2> hips) noexcept {
        Directions one;
        Directions two;
        turn(machine.zero_[0], machine.count_[0], counts, 0, one);
        turn(machine.zero_[1], machine.count_[1], counts, 1, two);
        const FiveBar linkage = machine.linkage_;
        const ObjectFrame frame = machine.frame_;
        for (std::size_t i = 0; i < counts.size(); ++i) {
            hips[i] = frame.point_to_object(
                linkage.handle_over(linkage.elbow_1_at({one.sin[i], one.cos[i]}),
                                    linkage.elbow_2_at({two.sin[i], two.cos[i]})));
        }
    }
};

ManyHips::ManyHips(const PantographSpec& machine) noexcept
    : linkage_(machine.linkage), frame_(machine.origin, machine.turn) {
    constexpr double kLargestCount = -static_cast<double>(std::numeric_limits<std::int32_t>::min());
    near_ = true;
    for (std::size_t i = 0; i < 2; ++i) {
        zero_[i] = machine.axes[i].zero;
        count_[i] = machine.axes[i].count_angle();
        const double largest = std::fabs(zero_[i]) + kLargestCount * count_[i];
        near_ = near_ && quarters_of(largest) + 1.0 < kMaxQuarters;
    }
}

void ManyHips::of(std::span<const Counts> counts, std::span<Vec2> hips) const noexcept {
    if (near_) {
        for (std::size_t first = 0; first < counts.size(); first += kAtOnce) {
            const std::size_t n = std::min(kAtOnce, counts.size() - first);
            as_this_processor_can(
                [&] { Loops::place(*this, counts.subspan(first, n), hips.subspan(first, n)); });
        }
        return;
    }
    std::transform(counts.begin(), counts.end(), hips.begin(), [this](const Counts& reading) {
        const SinCos one = sin_cos(zero_[0] + reading[0] * count_[0]);
        const SinCos two = sin_cos(zero_[1] + reading[1] * count_[1]);
        return frame_.point_to_object(
            linkage_.handle_over(linkage_.elbow_1_at(one), linkage_.elbow_2_at(two)));
    });
}

}  // namespace palpate::engine
