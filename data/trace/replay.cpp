#include "data/trace/replay.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/realtime/felt_scene.hpp"
#include "protocols/design/object_outline.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/chunk_replay.hpp"
#include "data/trace/columns.hpp"
#include "data/trace/retrace.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

/// A rule makes new scenes with every trial; a factorial design has fewer than this.
constexpr std::size_t kMaxScenes = 256;

template <class List>
std::size_t index_of(const List& list, const std::string& name, std::string_view what) {
    const auto found =
        std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.name == name; });
    refuse_if(found == list.end(), "the protocol has no {} \"{}\"", what, name);
    return static_cast<std::size_t>(found - list.begin());
}

template <class T>
bool same(const T& a, const T& b) noexcept {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

bool same_contact(const TickRecord& a, const TickRecord& b) noexcept {
    return same(a.go, b.go) && same(a.force, b.force) && same(a.normal_force, b.normal_force) &&
           same(a.tangential_force, b.tangential_force) && same(a.mu, b.mu) && same(a.u, b.u) &&
           a.segment == b.segment && a.mode == b.mode && a.flags == b.flags && same(a.v, b.v);
}

}  // namespace

std::string replay_sentence(std::int64_t trial, std::int64_t tick) {
    return fmt::format(
        "trial {}: from tick {} on the replay does not give what the servo had; read it with the "
        "palpate "
        "that recorded it (session_provenance), or use the stored columns alone",
        trial, tick);
}

ReplayResult replay(const engine::SceneView& scene,
                    const std::optional<engine::PantographSpec>& machine,
                    std::span<const ChunkView> chunks,
                    bool helped) {
    ChunkReplay work(machine, scene, chunks, helped);
    ReplayResult all;
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        if (!work.chunk(i).as_recorded && !all.differs_from) {
            all.differs_from = chunks[i].first_tick;
        }
    }
    all.ticks = work.take();
    return all;
}

void find_closest_points(const engine::SceneView& scene,
                         engine::FeltTrack& track,
                         std::span<TickRecord> ticks) noexcept {
    for (TickRecord& tick : ticks) {
        if (tick.mode == engine::Mode::free) {
            tick.cp = tick.go;
        } else if (scene.space != nullptr) {
            tick.cp = scene.space->feet().track(track.space, tick.hip).point;
        } else {
            const auto closest = scene.plane->closest(track.plane, engine::Vec2(tick.hip));
            tick.cp = engine::Vec3(closest.point, 0.0);
        }
    }
}

std::optional<engine::PantographSpec> machine_of(std::string_view calibration) {
    if (calibration.empty()) {
        return std::nullopt;
    }
    try {
        const auto machines = protocols::parse_calibrations(calibration, "calibration");
        return machines.size() == 1 && !machines.front().gantry
                 ? std::optional(machines.front().pantograph)
                 : std::nullopt;
    } catch (const protocols::ProtocolError&) {
        return std::nullopt;
    }
}

SessionTraces::SessionTraces(std::string_view protocol_toml, std::string_view calibration)
    : protocol_(protocols::stored_protocol(protocol_toml)), machine_(machine_of(calibration)) {}

std::shared_ptr<const engine::FeltScene> SessionTraces::scene_of(const TraceTrial& trial) {
    auto found = scenes_.find(trial);
    if (found == scenes_.end()) {
        protocols::Presentation felt{
            .object = protocol_.objects[index_of(protocol_.objects, trial.object, "object")],
            .friction =
                protocol_.frictions[index_of(protocol_.frictions, trial.friction, "friction")]};
        if (trial.curvature && trial.curvature != protocols::curvature_of(felt.object)) {
            felt.object.curvature = *trial.curvature;  // a rule's: of an object without a pose
        }
        felt.friction.mu_s = trial.mu_s.value_or(felt.friction.mu_s);
        felt.friction.mu_d = trial.mu_d.value_or(felt.friction.mu_d);
        if (trial.stimulus && protocol_.procedure &&
            protocol_.procedure->varies == protocols::Varies::compliance) {
            feel_stimulus(*protocol_.procedure, *trial.stimulus, felt);
        }
        const std::shared_ptr<engine::FeltScene> scene(
            new engine::FeltScene(protocols::make_felt_scene(protocol_, felt)));
        scene->restore_decay({.slip = trial.slip_decay, .heal = trial.heal_decay});
        if (scenes_.size() >= kMaxScenes) {
            scenes_.clear();
        }
        found = scenes_.emplace(trial, scene).first;
    }
    return found->second;
}

Ticks SessionTraces::replay(std::int64_t id,
                            const TraceTrial& trial,
                            std::span<const ChunkView> chunks) {
    ReplayResult all = data::replay(scene_of(trial).get(), machine_, chunks);
    if (all.differs_from) {
        throw TraceError(replay_sentence(id, *all.differs_from));
    }
    return std::move(all.ticks);
}

HipFromCounts::HipFromCounts(const engine::PantographSpec& machine) : machine_(machine) {}

void HipFromCounts::at(std::span<const engine::Pantograph::Counts> counts,
                       std::span<engine::Vec2> hips) noexcept {
    machine_.of(counts, hips);
    for (engine::Vec2& hip : hips) {
        last_ = std::isnan(hip.x) ? last_ : hip;
        hip = last_;
    }
}

Retrace::Retrace(const std::optional<engine::PantographSpec>& machine,
                 const engine::SceneView& scene)
    : scene_(scene), state_(std::make_unique<engine::FeltState>()) {
    if (machine) {
        machine_.emplace(*machine);
    }
}

Retrace::~Retrace() = default;

void Retrace::contacts(std::span<TickRecord> ticks) noexcept {
    engine::set_contacts(ticks, scene_, *state_);
}

/// What follows from the other columns.
engine::Vec3 Retrace::hip_of(const TickRecord& tick, std::size_t i) const noexcept {
    if (scene_.space != nullptr) {
        const auto whole = [](double metres) {
            return steps_in_metres(in_steps(metres, kHipSteps));
        };
        return {whole(tick.hip.x), whole(tick.hip.y), whole(tick.hip.z)};
    }
    return {machine_ ? hips_[i] : engine::Vec2{}, 0.0};
}

void Retrace::parts(std::span<const TickRecord> ticks, std::span<std::uint8_t> parts) {
    if (machine_) {
        counts_.resize(ticks.size());
        hips_.resize(ticks.size());
        std::ranges::transform(ticks, counts_.begin(), &TickRecord::counts);
        machine_->at(counts_, hips_);
    }
    again_.resize(ticks.size());
    for (std::size_t i = 0; i < ticks.size(); ++i) {  // what a contact depends on, or leaves alone
        again_[i].hip = ticks[i].hip;
        again_[i].v = ticks[i].v;
        again_[i].flags = ticks[i].flags;
    }
    contacts(again_);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        const TickRecord& tick = ticks[i];
        const auto us = static_cast<double>(tick.lateness_us);
        const auto part = [](bool follows, Part bit) {
            return follows ? 0U : static_cast<unsigned>(bit);
        };
        parts[i] = static_cast<std::uint8_t>(
            part(same(hip_of(tick, i), tick.hip), part_hip) |
            part(scene_.any() && same_contact(again_[i], tick), part_contact) |
            part(same(tick.command, tick.force), part_command) |
            part(same(lateness_us(in_steps(us, kLatenessSteps)), tick.lateness_us), part_lateness));
    }
}

}  // namespace palpate::data
