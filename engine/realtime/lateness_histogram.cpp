#include "engine/realtime/lateness_histogram.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace palpate::engine {
namespace {

/// Bins to an octave: 2^kBits.
constexpr int kBits = 5;
constexpr std::uint64_t kOctave = 1U << kBits;

/// "9.6 us", "340 us", "2.3 ms": truncated, three digits at most where that is enough.
std::string duration(std::int64_t ns) {
    const auto with_tenth = [](std::int64_t tenths, const char* unit) {
        return std::to_string(tenths / 10) + '.' + std::to_string(tenths % 10) + unit;
    };
    return ns < 100'000   ? with_tenth(ns / 100, " us")
         : ns < 1'000'000 ? std::to_string(ns / 1'000) + " us"
                          : with_tenth(ns / 100'000, " ms");
}

}  // namespace

std::size_t LatenessHistogram::bin_of(std::int64_t ns) noexcept {
    const auto value = static_cast<std::uint64_t>(ns);
    if (value < 2 * kOctave) {
        return value;
    }
    const int shift = static_cast<int>(std::bit_width(value)) - 1 - kBits;
    const std::uint64_t bin = static_cast<std::uint64_t>(shift) * kOctave + (value >> shift);
    return std::min<std::size_t>(bin, kBins - 1);
}

std::int64_t LatenessHistogram::last_of(std::size_t bin) noexcept {
    if (bin < 2 * kOctave) {
        return static_cast<std::int64_t>(bin);
    }
    const std::uint64_t shift = bin / kOctave - 1;
    const std::uint64_t mantissa = bin % kOctave + kOctave;
    return static_cast<std::int64_t>(((mantissa + 1) << shift) - 1);
}

void LatenessHistogram::add(std::int64_t lateness_ns, bool late) noexcept {
    const std::int64_t ns = std::max<std::int64_t>(0, lateness_ns);
    ++bins_[bin_of(ns)];
    ++count_;
    late_ += late ? 1 : 0;
    max_ = std::max(max_, ns);
}

void LatenessHistogram::add(const LatenessHistogram& other) noexcept {
    for (std::size_t i = 0; i < kBins; ++i) {
        bins_[i] += other.bins_[i];
    }
    count_ += other.count_;
    late_ += other.late_;
    missed_ += other.missed_;
    max_ = std::max(max_, other.max_);
}

std::int64_t LatenessHistogram::quantile_ns(double share) const noexcept {
    const double wanted = std::ceil(std::clamp(share, 0.0, 1.0) * static_cast<double>(count_));
    std::int64_t seen = 0;
    for (std::size_t i = 0; i < kBins; ++i) {
        seen += bins_[i];
        if (seen > 0 && static_cast<double>(seen) >= wanted) {
            return i + 1 == kBins ? max_ : std::min(max_, last_of(i));
        }
    }
    return max_;
}

std::int64_t LatenessHistogram::below(std::int64_t bound_ns) const noexcept {
    std::int64_t seen = 0;
    for (std::size_t i = 0; i < kBins && last_of(i) < bound_ns; ++i) {
        seen += bins_[i];
    }
    return seen;
}

std::string describe(const LatenessHistogram& lateness) {
    return std::to_string(lateness.count()) + " ticks, late by " +
           duration(lateness.quantile_ns(0.5)) + " (half of them), " +
           duration(lateness.quantile_ns(0.99)) + " (99 %), " + duration(lateness.max_ns()) +
           " (worst); " + std::to_string(lateness.late()) + " more than half a period late, " +
           std::to_string(lateness.missed()) + " missed";
}

}  // namespace palpate::engine
