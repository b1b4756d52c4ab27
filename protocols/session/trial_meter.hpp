#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/realtime/scene_view.hpp"
#include "engine/rendering/energy_ledger.hpp"
#include "protocols/protocol/protocol.hpp"
#include "protocols/session/exploration_meter.hpp"
#include "protocols/session/recorder.hpp"

namespace palpate::protocols {

/// Adds up a trial's ticks while they come. Contour following is made of strokes, stops and turns
/// (S. J. Lederman, R. L. Klatzky, Cognitive Psychology 19:342, 1987).
class TrialMeter {
public:
    static constexpr std::int64_t kWindow = 20'000'000;  ///< ns over which a speed is taken

    /// In space nothing is before or after a vertex. @param stiffness  K of the contact, N/m
    TrialMeter(double stiffness, const engine::SceneView& scene);
    void add(std::span<const engine::TickRecord> ticks);
    [[nodiscard]] TrialSummary summary() const;

private:
    void add_stroke(const engine::TickRecord& tick);
    void add_contact(const engine::TickRecord& tick);
    void add_speed(const engine::TickRecord& tick);

    TrialSummary sum_{};
    engine::EnergyLedger<3> ledger_;
    StrokeCounter strokes_;
    StrokeCounter across_;  ///< on a surface: along y
    std::variant<OutlineCover, PatchCover> cover_;
    bool in_space_ = false;
    double force_sum_ = 0.0;      ///< N, over contact ticks
    double contact_path_ = 0.0;   ///< m, of the steps that end in contact
    double contact_time_ = 0.0;   ///< s, of these steps
    engine::Vec3 from_{};         ///< where the window of a speed began
    std::int64_t from_time_ = 0;  ///< ns
    std::vector<double> speeds_;  ///< m/s, of such windows with nothing but contact in them
    std::vector<double> forces_;  ///< N, rendered, of contact ticks
    bool started_ = false;
    engine::Mode last_mode_ = engine::Mode::free;
    engine::Vec3 last_hip_{};
    engine::Vec3 last_force_{};
    std::int64_t last_time_ = 0;  ///< ns
};

/// A number of TrialSummary with its column in trial, presentation or both. What it is computed
/// from is TrialMeter's; columns, rows, exports, verify and together() follow from this.
struct Measure {
    using Value = std::variant<std::monostate, std::int64_t, double>;  ///< none: NULL
    enum class Needs : std::uint8_t { nothing, friction, force };      ///< without: NULL

    std::string_view column;  ///< ends with its unit
    Value (*value)(const TrialSummary&);
    /// Two intervals as one; `all` begins as the first.
    void (*add)(const TrialSummary& first, const TrialSummary& second, TrialSummary& all);
    int in_trial;     ///< place of the column in the table, from 1; 0: it is not generated there
    int in_interval;  ///< the same in presentation
    std::string_view meaning;
    Needs needs = Needs::nothing;
};

/// All of them, each once.
[[nodiscard]] std::span<const Measure> measures() noexcept;
/// @param force  the device of the trial gives some
[[nodiscard]] Measure::Value measured(const Measure& measure, const TrialSummary& sum, bool force);

/// Two intervals as one: counts and ways are added up, means weigh by contact, the largest and the
/// first remain. first_contact_s is that of the first interval with any, within it. What is of an
/// interval alone (deciles, covered_share, start) stays that of the first.
[[nodiscard]] TrialSummary together(const TrialSummary& first, const TrialSummary& second);

/// Which rules an answered trial breaks: "contact below 1 s". Empty: it counts. How much was felt
/// is in the summary alone: this is said while the session runs, to who must not guess the
/// condition.
/// @param late_counts  false for a simulated hand: nobody felt the lateness
[[nodiscard]] std::string why_invalid(const Protocol& protocol,
                                      const TrialSummary& summary,
                                      bool late_counts);
/// Of all intervals of a trial: each has to be felt, and of two it is said which was not.
[[nodiscard]] std::string why_invalid(const Protocol& protocol,
                                      std::span<const TrialSummary> intervals,
                                      bool late_counts);

}  // namespace palpate::protocols
