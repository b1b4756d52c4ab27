#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "data/inference/trials.hpp"
#include "data/tables/table.hpp"

/// Does anything but friction differ between the conditions? One number a person and friction,
/// differences within person, and whether these are known to be small.
namespace palpate::data {

/// What is known of a difference that should be none.
enum class Sameness : std::uint8_t {
    same,     ///< within the bounds, by both one-sided tests at 5 %
    within,   ///< so, and not 0 by the interval of 95 %: it differs by less than matters
    differs,  ///< not 0, by the interval of 95 %, and not within the bounds
    open,     ///< neither: too few people
};

/// Whether a difference within people is small enough, and not only not significant.
struct Equivalence {
    std::size_t people = 0;
    double mean = 0.0;
    /// 90 %: inside -bound .. bound exactly if both one-sided t-tests at 5 % say so (D. J.
    /// Schuirmann, J. Pharmacokinet. Biopharm. 15:657, 1987). Where all people have one value, that
    /// value twice.
    double low = 0.0;
    double high = 0.0;
    Sameness verdict = Sameness::open;

    /// The interval of 90 % lies within the bounds.
    [[nodiscard]] bool bounded() const {
        return verdict == Sameness::same || verdict == Sameness::within;
    }
};

/// @param differences  one a person, finite @param bound > 0 @return nothing of fewer than two
/// people
[[nodiscard]] std::optional<Equivalence> equivalence(std::span<const double> differences,
                                                     double bound);

/// Means that are no further from each other are the same. Choices, and printed.
struct AuditBounds {
    double place_m = 0.002;  ///< of start poses
    double ratio = 1.1;      ///< of times, forces, speeds, counts: up or down
    double share = 0.005;    ///< of ticks
};

/// In what a quantity's difference is counted.
enum class AuditScale : std::uint8_t {
    place,  ///< m
    ratio,  ///< the logarithm of a ratio
    share,  ///< of ticks or trials
};

/// A quantity that an audit compares.
struct AuditedQuantity {
    std::string_view title;
    std::string_view name;   ///< of a column of its means
    std::string_view value;  ///< SQL, of a row of exploration and its trial and presentation
    AuditScale scale = AuditScale::share;
    bool rig =
        true;  ///< nothing of it may differ; false: of the hand, which friction may have changed
};
/// All that an audit looks at, in the order of its table.
[[nodiscard]] std::span<const AuditedQuantity> audited_quantities();

/// One quantity of one friction against the base.
struct AuditLine {
    const AuditedQuantity* quantity = nullptr;
    std::string friction{};  ///< against Audit::base
    std::size_t people = 0;
    std::optional<Equivalence> found{};  ///< nothing: too few people
    double bound = 0.0;                  ///< as `found`: m, logarithm of a ratio, share
};

/// Who has no answer with a friction, so no difference with it.
struct AuditGap {
    std::string friction;
    std::vector<std::string> people{};
};

/// All lines of a study.
struct Audit {
    std::string study{};
    std::string base{};  ///< the one of least friction
    std::vector<AuditLine> lines{};
    std::vector<AuditGap> gaps{};
    LeftOut left_out{};
};

/// Rig and hand, friction by friction against the one of least friction: start pose, late, stale
/// and saturated ticks, gaps of the masking noise; times, strokes, force, speed. Answered main
/// trials that count, of one study and kind, without whom the protocol's rules leave out.
/// @throws std::invalid_argument if there are none, of several studies, or of one friction alone:
/// which there are
[[nodiscard]] Audit audit_of(Database& database,
                             const AnswerChoice& choice,
                             const AuditBounds& bounds);

/// Who is in no difference, and why, in one line.
[[nodiscard]] std::string gap_text(const AuditGap& gap);

/// A row a quantity and friction: differences, intervals and bounds in m, as ratios, as shares.
[[nodiscard]] Table audit_table(const Audit& audit);

/// audit_of() as a table for people.
[[nodiscard]] std::string audit_text(Database& database,
                                     const AnswerChoice& choice,
                                     const AuditBounds& bounds);

/// The same for programs.
[[nodiscard]] std::string audit_json(Database& database,
                                     const AnswerChoice& choice,
                                     const AuditBounds& bounds);

}  // namespace palpate::data
