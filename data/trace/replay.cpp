#include "data/trace/replay.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <future>
#include <stdexcept>

#include <fmt/format.h>

#include "protocols/design/object_outline.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "data/trace/derived_hash.hpp"
#include "data/trace/fixed_point.hpp"
#include "data/trace/retrace.hpp"

namespace palpate::data {
namespace {

using engine::TickRecord;

/// A rule makes new scenes with every trial; a factorial design has fewer than this.
constexpr std::size_t kMostScenes = 256;

template <class List>
std::size_t index_of(const List& list, const std::string& name, std::string_view what) {
    const auto found =
        std::find_if(list.begin(), list.end(), [&](const auto& item) { return item.name == name; });
    if (found == list.end()) {
        throw std::invalid_argument(fmt::format("the protocol has no {} \"{}\"", what, name));
    }
    return static_cast<std::size_t>(found - list.begin());
}

/// The columns that are in every chunk, without the fixed-point ones, which the exact numbers say.
class StoredNumbers {
public:
    void read(const ChunkView& chunk, ChunkReader& reader) {
        for (std::size_t i = 0; i < values_.size(); ++i) {
            values_[i].resize(chunk.ticks);
            reader.read(static_cast<Stored>(i), values_[i]);
        }
    }
    [[nodiscard]] std::int64_t at(Stored column, std::size_t tick) const {
        return values_[static_cast<std::size_t>(column)][tick];
    }

private:
    std::array<std::vector<std::int64_t>, static_cast<std::size_t>(Stored::hip_x)> values_;
};

void set_stored(TickRecord& tick, const StoredNumbers& stored, std::size_t i) {
    const auto number = [&](Stored column) {
        return static_cast<std::int32_t>(stored.at(column, i));
    };
    tick.tick = stored.at(Stored::tick, i);
    tick.time_ns = stored.at(Stored::time_ns, i);
    tick.counts = {number(Stored::count_1), number(Stored::count_2)};
    tick.codes = {number(Stored::code_1), number(Stored::code_2)};
    tick.lateness_us = lateness_us(stored.at(Stored::lateness_ns, i));
    tick.flags = static_cast<std::uint8_t>(stored.at(Stored::flags, i));
}

void exclusive_or(double& value, double with) noexcept {
    std::uint64_t a = 0;
    std::uint64_t b = 0;
    std::memcpy(&a, &value, sizeof a);
    std::memcpy(&b, &with, sizeof b);
    a ^= b;
    std::memcpy(&value, &a, sizeof a);
}

void require_modes(std::span<const TickRecord> ticks) {
    for (const TickRecord& tick : ticks) {
        if (static_cast<unsigned>(tick.mode) > static_cast<unsigned>(engine::Mode::transition)) {
            throw TraceError("a trace chunk holds an unknown contact mode");
        }
    }
}

/// What the bytes of a chunk tell without its scene: all but the contact. One chunk after the other.
class Unpacker {
public:
    explicit Unpacker(const std::optional<engine::PantographSpec>& machine)
        : retrace_(machine, nullptr) {}

    /// @return the exact columns of each tick; none where the chunk has none
    std::vector<TickRecord> unpack(const ChunkView& chunk, std::span<TickRecord> ticks) {
        ChunkReader reader(chunk);
        stored_.read(chunk, reader);
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            set_stored(ticks[i], stored_, i);
        }
        retrace_hips(ticks);
        for (std::size_t i = 0; i < ticks.size(); ++i) {
            ticks[i].hip = hips_[i];
        }
        std::vector<TickRecord> exact(chunk.parts == 0 ? 0 : ticks.size());
        if (!exact.empty()) {
            reader.read_exact(exact);
            require_modes(exact);
        }
        return exact;
    }

private:
    void retrace_hips(std::span<const TickRecord> ticks) {
        counts_.resize(ticks.size());
        hips_.resize(ticks.size());
        std::transform(ticks.begin(), ticks.end(), counts_.begin(),
                       [](const TickRecord& tick) { return tick.counts; });
        retrace_.hips(counts_, hips_);
    }

    Retrace retrace_;
    StoredNumbers stored_;
    std::vector<engine::Pantograph::Counts> counts_;
    std::vector<engine::Vec2> hips_;
};

void set_exact(TickRecord& tick, std::uint8_t parts, const TickRecord& exact) noexcept {
    if ((parts & part_contact) != 0) {
        tick.go = exact.go;
        tick.force = exact.force;
        tick.normal_force = exact.normal_force;
        tick.tangential_force = exact.tangential_force;
        tick.mu = exact.mu;
        tick.u = exact.u;
        tick.segment = exact.segment;
        tick.mode = exact.mode;
    }
    tick.command = tick.force;
    if ((parts & part_command) != 0) {
        tick.command = exact.command;
        exclusive_or(tick.command.x, tick.force.x);
        exclusive_or(tick.command.y, tick.force.y);
    }
    if ((parts & part_lateness) != 0) {
        tick.lateness_us = exact.lateness_us;
    }
}

/// The contacts of unpacked ticks. @return whether they are what the servo had
bool follow(Retrace& contacts,
            const ChunkView& chunk,
            std::span<TickRecord> ticks,
            std::span<const TickRecord> exact) noexcept {
    for (std::size_t i = 0; i < exact.size(); ++i) {
        TickRecord& tick = ticks[i];
        if ((chunk.parts & part_hip) != 0) {
            tick.hip = exact[i].hip;
        }
        const std::uint8_t flags = tick.flags;
        contacts.contact(tick);
        tick.flags = (chunk.parts & part_contact) != 0 ? flags : tick.flags;
        set_exact(tick, chunk.parts, exact[i]);
    }
    for (std::size_t i = exact.size(); i < ticks.size(); ++i) {
        contacts.contact(ticks[i]);
        ticks[i].command = ticks[i].force;
    }
    return derived_hash(ticks) == chunk.derived;
}

/// Where the ticks of each chunk lie. A number of ticks that is damaged takes no room: its chunk cannot be read.
std::vector<std::span<TickRecord>> places_in(std::vector<TickRecord>& all,
                                             std::span<const ChunkView> chunks) {
    std::size_t ticks = 0;
    for (const ChunkView& chunk : chunks) {
        ticks += std::min(chunk.ticks, kChunkTicks);
    }
    all.resize(ticks);
    std::vector<std::span<TickRecord>> places;
    std::span<TickRecord> left(all);
    for (const ChunkView& chunk : chunks) {
        const std::size_t count = std::min(chunk.ticks, kChunkTicks);
        places.push_back(left.first(count));
        left = left.subspan(count);
    }
    return places;
}

}  // namespace

std::string replay_sentence(std::int64_t trial, std::int64_t tick) {
    return fmt::format(
        "trial {}: from tick {} on the replay does not give what the servo had; read it with the "
        "palpate "
        "that recorded it (session_provenance), or use the stored columns alone",
        trial, tick);
}

Replayed replay(const engine::Scene* scene,
                const std::optional<engine::PantographSpec>& machine,
                std::span<const ChunkView> chunks) {
    Replayed all;
    const auto places = places_in(all.ticks, chunks);
    Unpacker unpacker(machine);
    Retrace contacts(std::nullopt, scene);
    const auto unpack = [&](std::size_t i) {
        return unpacker.unpack(chunks[i], places[i]);
    };
    std::future<std::vector<TickRecord>> next;
    for (std::size_t i = 0; i < chunks.size(); ++i) {
        const std::vector<TickRecord> exact = i == 0 ? unpack(i) : next.get();
        if (i + 1 < chunks.size()) {
            next = std::async(unpack, i + 1);  // a thread of its own, where there can be one
        }
        if (!follow(contacts, chunks[i], places[i], exact) && !all.differs_from) {
            all.differs_from = chunks[i].first_tick;
        }
    }
    return all;
}

void find_closest_points(const engine::Scene& scene, std::span<TickRecord> ticks) noexcept {
    engine::TrackState track;
    for (TickRecord& tick : ticks) {
        tick.cp = tick.mode == engine::Mode::free ? tick.go : scene.closest(track, tick.hip).point;
    }
}

void read_stored(const ChunkView& chunk, Stored column, std::span<std::int64_t> values) {
    ChunkReader(chunk).read(column, values);
}

std::optional<engine::PantographSpec> machine_of(std::string_view calibration) {
    if (calibration.empty()) {
        return std::nullopt;
    }
    try {
        const auto machines = protocols::parse_calibrations(calibration, "calibration");
        return machines.size() == 1 ? std::optional(machines.front().pantograph) : std::nullopt;
    } catch (const protocols::ProtocolError&) {
        return std::nullopt;
    }
}

SessionTraces::SessionTraces(std::string_view protocol_toml, std::string_view calibration)
    : SessionTraces(protocols::stored_protocol(protocol_toml), machine_of(calibration)) {}

SessionTraces::SessionTraces(protocols::Protocol protocol,
                             std::optional<engine::PantographSpec> machine)
    : protocol_(std::move(protocol)), machine_(std::move(machine)) {}

const engine::Scene& SessionTraces::scene_of(const TraceTrial& trial) {
    const Felt key(trial.object, trial.friction, trial.curvature, trial.mu_s, trial.mu_d);
    auto found = scenes_.find(key);
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
        std::unique_ptr<engine::Scene> scene(
            new engine::Scene(protocols::make_scene(protocol_, felt)));
        if (scenes_.size() >= kMostScenes) {
            scenes_.clear();
        }
        found = scenes_.emplace(key, std::move(scene)).first;
    }
    engine::Scene& scene = *found->second;
    scene.restore_decay({.slip = trial.slip_decay, .heal = trial.heal_decay});
    return scene;
}

Replayed SessionTraces::replay(const TraceTrial& trial, std::span<const ChunkView> chunks) {
    return data::replay(&scene_of(trial), machine_, chunks);
}

}  // namespace palpate::data
