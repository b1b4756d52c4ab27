#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace palpate::engine {

/// How late a loop woke, tick by tick, in bins: exact to the ns below 64 ns, to 1/32 above, up to
/// 17 s. A plain value of 4 KB; add() allocates nothing and is a handful of instructions.
class LatenessHistogram {
public:
    /// @param lateness_ns  wake-up minus deadline; below 0 counts as 0
    /// @param late         the tick was flagged as late
    void add(std::int64_t lateness_ns, bool late) noexcept;
    /// Deadlines that were slept through.
    void add_missed(std::int64_t deadlines) noexcept { missed_ += deadlines; }
    /// Puts another one's ticks into this one.
    void add(const LatenessHistogram& other) noexcept;

    /// Ticks, those that woke late, deadlines slept through, and the largest lateness, ns.
    [[nodiscard]] std::int64_t count() const noexcept { return count_; }
    [[nodiscard]] std::int64_t late() const noexcept { return late_; }
    [[nodiscard]] std::int64_t missed() const noexcept { return missed_; }
    [[nodiscard]] std::int64_t max_ns() const noexcept { return max_; }
    /// Lateness that at least `share` of the ticks do not exceed, to the upper end of its bin and
    /// not above max_ns(); 0 without ticks.
    [[nodiscard]] std::int64_t quantile_ns(double share) const noexcept;
    /// Ticks with lateness below `bound_ns`, as far as bins tell.
    [[nodiscard]] std::int64_t below(std::int64_t bound_ns) const noexcept;

private:
    static constexpr std::size_t kBins = 960;

    [[nodiscard]] static std::size_t bin_of(std::int64_t ns) noexcept;
    [[nodiscard]] static std::int64_t last_of(std::size_t bin) noexcept;

    std::array<std::uint32_t, kBins> bins_{};
    std::int64_t count_ = 0;
    std::int64_t late_ = 0;
    std::int64_t missed_ = 0;
    std::int64_t max_ = 0;
};

/// For the record of a session and for people: "5031 ticks, late by 15.1 us (half of them), 25.6 us
/// (99 %), 1.2 ms (worst); 3 more than half a period late, 2 missed".
[[nodiscard]] std::string describe(const LatenessHistogram& lateness);

}  // namespace palpate::engine
