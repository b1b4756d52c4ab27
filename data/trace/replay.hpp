#pragma once

#include <compare>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "engine/device/calibration.hpp"
#include "engine/realtime/scene_view.hpp"
#include "engine/realtime/tick_record.hpp"
#include "protocols/protocol/protocol.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/ticks.hpp"

/// Reads traces from plain values: needs no database class, so that an extension that has a
/// connection of its own can use it. Not for several threads at once.
namespace palpate::data {

/// What of a trial a trace needs besides its chunks.
struct TraceTrial {
    std::string object;    ///< plan.object
    std::string friction;  ///< plan.friction
    double slip_decay = 0.0;
    double heal_decay = 0.0;
    // As felt, table presentation; nothing: as the protocol has it.
    std::optional<double> curvature{};
    std::optional<double> mu_s{};
    std::optional<double> mu_d{};
    std::optional<double> stimulus{};  ///< what a rule chose, where it chose the compliance

    friend auto operator<=>(const TraceTrial&, const TraceTrial&) = default;
};

/// The ticks of a trial again, and from where on they may differ.
struct ReplayResult {
    Ticks ticks;
    /// The first chunk whose hash the replay does not give: from here on the columns that were not
    /// stored are those of another palpate, compiler or machine. Nothing: every bit is as the servo
    /// had it.
    std::optional<std::int64_t> differs_from;
};

/// What a person reads where it gives other numbers than the servo had: of which trial and tick,
/// and the remedy.
[[nodiscard]] std::string replay_sentence(std::int64_t trial, std::int64_t tick);

/// The trials of one session.
class SessionTraces {
public:
    /// @param protocol_toml  study.protocol_toml
    /// @param calibration    the session's provenance "calibration"; empty: there is none
    /// @throws protocols::ProtocolError if the protocol cannot be read. A calibration that cannot
    ///         be read is none: no chunk that needs it reproduces its hash
    SessionTraces(std::string_view protocol_toml, std::string_view calibration);

    /// All ticks of one interval, from its chunks in the order of first_tick, each field as it was:
    /// without closest points, which no servo needs.
    /// @param id  of the trial
    /// @throws TraceError if a chunk is damaged, or a column that was not stored does not come out
    ///         as it was; std::invalid_argument if the scene cannot be built
    [[nodiscard]] Ticks replay(std::int64_t id,
                               const TraceTrial& trial,
                               std::span<const ChunkView> chunks);

    /// The scene of the trial, with the decays that were recorded.
    /// @throws std::invalid_argument if it cannot be built
    [[nodiscard]] std::shared_ptr<const engine::FeltScene> scene_of(const TraceTrial& trial);

    /// By which HIP follows from counts; none: HIP itself was stored.
    [[nodiscard]] const std::optional<engine::PantographSpec>& machine() const noexcept {
        return machine_;
    }

    /// Objects are surfaces: HIP follows from its own columns, and no calibration is needed.
    [[nodiscard]] bool in_space() const noexcept { return protocol_.surface.has_value(); }

private:
    protocols::Protocol protocol_;
    std::optional<engine::PantographSpec> machine_;
    std::map<TraceTrial, std::shared_ptr<const engine::FeltScene>> scenes_;
};

/// The pantograph of a canonical calibration text, if it is one; of three straight axes HIP follows
/// from its own columns.
[[nodiscard]] std::optional<engine::PantographSpec> machine_of(std::string_view calibration);

/// Replay of one interval with a scene that is there already; no scene: only what is stored. The
/// closest points are left out: see find_closest_points(). Chunk by chunk: ChunkReplay.
/// @param helped  by a thread; not where intervals are replayed side by side
[[nodiscard]] ReplayResult replay(const engine::SceneView& scene,
                                  const std::optional<engine::PantographSpec>& machine,
                                  std::span<const ChunkView> chunks,
                                  bool helped = true);

/// The closest point of the next ticks of an interval, from its first one on: out of contact the
/// one that was last looked for, which is where the god-object is.
/// @param track  of these questions alone; new before the first tick
void find_closest_points(const engine::SceneView& scene,
                         engine::FeltTrack& track,
                         std::span<engine::TickRecord> ticks) noexcept;

}  // namespace palpate::data
