#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/base/sha256.hpp"

namespace palpate::protocols {

/// What a procedure says of one quantity so far.
struct Estimate {
    std::string name;            ///< threshold, slope, ...; the staircase's name
    std::optional<double> mean;  ///< of the posterior, or of a staircase's last reversals
    std::optional<double> mode;  ///< of the posterior
    std::optional<double> sd{};  ///< of the posterior; of those reversals, n - 1 below
    /// 95 % credible: the least values with 2.5 % and 97.5 % of the posterior at or below them, so
    /// that it holds 95 % or more. None of a staircase.
    std::optional<double> low{};
    std::optional<double> high{};
    bool cut = false;  ///< it ends where the posterior's grid does: there may be more beyond
    std::size_t reversals = 0;  ///< of a staircase: how many the mean is of

    friend bool operator==(const Estimate&, const Estimate&) = default;
};

/// A value of a quantity, and the share of the posterior that it has.
using Weighed = std::pair<double, double>;

/// sd, low, high and cut of a posterior; its mean too.
/// @param values  increasing; the shares add up to 1
[[nodiscard]] Estimate belief(std::string name, std::span<const Weighed> values);

/// The bytes by which the state of a procedure is named. Numbers are 8 bytes, the lowest first
/// (doubles by their IEEE-754 bits); texts and lists carry their length, so that no state can pass
/// for another.
class StateBytes {
public:
    /// @param kind  of rule: two rules never share a state
    explicit StateBytes(std::string_view kind) { add(kind); }

    /// 8 bytes, the lowest first; of a double its bits; of a text or a list first its length.
    void add(std::uint64_t word) {
        for (unsigned shift = 0; shift < 64; shift += 8) {
            bytes_.push_back(static_cast<std::byte>((word >> shift) & 0xFFU));
        }
    }
    void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
    void add(std::string_view text) {
        add(std::uint64_t{text.size()});
        for (const char c : text) {
            bytes_.push_back(static_cast<std::byte>(c));
        }
    }
    void add(std::span<const double> list) {
        add(std::uint64_t{list.size()});
        for (const double number : list) {
            add(number);
        }
    }

    /// SHA-256, 64 hexadecimal digits.
    [[nodiscard]] std::string hash() const { return sha256_hex(std::span(bytes_)); }

private:
    std::vector<std::byte> bytes_;
};

}  // namespace palpate::protocols
