#include "tests/bench/data/own_store.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "engine/base/side_by_side.hpp"
#include "engine/device/simulated_pantograph.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "data/extension/sample_module.hpp"
#include "data/store/own_schema.hpp"
#include "data/store/session_store.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/derived_hash.hpp"
#include "data/trace/replay.hpp"
#include "data/trace/retrace.hpp"

namespace palpate::bench {
namespace {

using engine::TickRecord;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kFirst = 10;  ///< position of the first made trial: after practice
constexpr std::size_t kMade = 10;

engine::Calibration simulated_machine() {
    return {.pantograph = engine::PantographModel{}.plant.machine};
}

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

class OwnStore : public TraceStore {
public:
    OwnStore(const std::string& folder, const MadeStudy& study)
        : study_(study),
          file_(folder + "/palpate.sqlite"),
          database_(file_, data::Access::write),
          session_(open_session(
              database_,
              {.protocol = study.protocol,
               .protocol_hash = study.hash,
               .plan = study.plan,
               .key = study.key,
               .seed = study.protocol.seed,
               .kind = data::RunKind::simulated,
               .device = "simulated pantograph",
               .provenance = {{"calibration", protocols::to_toml(simulated_machine())}}})),
          recorder_(database_, study.protocol, session_.id) {
        if (data::add_extension(database_.handle()) != 0) {
            throw std::runtime_error("cannot add the table sample");
        }
    }

    [[nodiscard]] std::string name() const override { return "palpate"; }

    /// A trial as one transaction, as after a session without pauses: its chunks, then its end.
    void write(std::int64_t trial, std::span<const TickRecord> ticks) override {
        const auto& planned =
            study_.plan.trials.at(kFirst + static_cast<std::size_t>(trial - 1) % kMade);
        const engine::Scene scene = make_scene(study_.protocol, planned.condition);
        const protocols::TrialId id = recorder_.begin_trial(planned);
        recorder_.begin_interval(
            id, presentations_of(study_.protocol, planned).front(),
            {.slip_decay = scene.decay().slip, .heal_decay = scene.decay().heal});
        recorder_.append(id, ticks);
        recorder_.end_trial(id, {.outcome = protocols::Outcome::aborted});
        ids_.push_back(id);
    }
    void finish() override { database_.checkpoint(); }
    [[nodiscard]] std::uintmax_t bytes() const override {
        return std::filesystem::file_size(file_);
    }
    [[nodiscard]] double mean_normal_force(std::int64_t trial) override {
        return value(fmt::format("SELECT avg(rendered_normal_n) FROM sample WHERE trial_id = {}",
                                 ids_.at(static_cast<std::size_t>(trial - 1))));
    }
    [[nodiscard]] double mean_command_x() override {
        return value("SELECT avg(commanded_x_n) FROM sample");
    }

private:
    [[nodiscard]] double value(const std::string& sql) {
        data::Statement row = database_.prepare(sql);
        row.step();
        return row.real(0);
    }

    const MadeStudy& study_;
    std::string file_;
    data::Database database_;
    data::OpenedSession session_;
    data::SqliteRecorder recorder_;
    std::vector<protocols::TrialId> ids_;
};

/// The chunks of one trial in memory.
struct Chunks {
    std::vector<data::EncodedChunk> encoded;
    std::vector<data::ChunkView> views;
};

Chunks encode_all(const std::vector<TickRecord>& ticks,
                  const engine::Scene& scene,
                  std::int64_t period_ns) {
    Chunks chunks;
    data::Retrace retrace(simulated_machine().pantograph, &scene);
    for (std::size_t first = 0; first < ticks.size(); first += data::kChunkTicks) {
        const auto part =
            std::span(ticks).subspan(first, std::min(data::kChunkTicks, ticks.size() - first));
        std::uint8_t parts = 0;
        for (const TickRecord& tick : part) {
            parts = static_cast<std::uint8_t>(parts | retrace.parts(tick));
        }
        chunks.views.push_back({.first_tick = part.front().tick,
                                .ticks = part.size(),
                                .period_ns = period_ns,
                                .parts = parts,
                                .derived = data::derived_hash(part)});
        chunks.encoded.push_back(data::encode_chunk(part, part.front().tick, period_ns, parts));
    }
    for (std::size_t i = 0; i < chunks.views.size(); ++i) {
        chunks.views[i].crc32 = chunks.encoded[i].crc32;
        chunks.views[i].data = chunks.encoded[i].data;
    }
    return chunks;
}

}  // namespace

std::unique_ptr<TraceStore> own_store(const std::string& folder, const MadeStudy& study) {
    return std::make_unique<OwnStore>(folder, study);
}

namespace {

constexpr int kTimes = 10;  ///< each replay, so that a run takes a while

/// A made trial as it is stored, and what it is replayed with.
struct ColumnId {
    std::unique_ptr<const engine::Scene> scene;
    Chunks chunks;
};

void replay(const ColumnId& trial, bool helped) {
    const data::ReplayResult again =
        data::replay(trial.scene.get(), simulated_machine().pantograph, trial.chunks.views, helped);
    if (again.differs_from) {
        throw std::runtime_error("the replay differs from what was made");
    }
}

double seconds_side_by_side(const std::vector<ColumnId>& trials) {
    const auto start = Clock::now();
    SideBySide work;
    std::size_t last = 0;
    for (int i = 0; i < kTimes; ++i) {
        for (const ColumnId& trial : trials) {
            last = work.add([&trial] { replay(trial, false); });
        }
    }
    for (std::size_t i = 0; i <= last; ++i) {
        work.wait_for(i);
    }
    return seconds_since(start);
}

double seconds_one_by_one(const std::vector<ColumnId>& trials) {
    const auto start = Clock::now();
    for (int i = 0; i < kTimes; ++i) {
        for (const ColumnId& trial : trials) {
            replay(trial, true);
        }
    }
    return seconds_since(start);
}

/// Before any other file is opened: the first open of a program reads the catalogue too. Time of the
/// processor: less than a millisecond is soon lost to another program.
void measure_schema(Own& own) {
    const data::Database database("schema", data::Access::memory);
    std::vector<double> ms;
    for (int i = 0; i < 201; ++i) {
        const std::clock_t start = std::clock();
        if (!data::schema_differences(database.connection()).empty()) {
            throw std::runtime_error("a new file's schema differs from the catalogue");
        }
        ms.push_back(1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    own.schema_first_ms = ms.front();
    std::ranges::sort(ms);
    own.schema_ms = ms[ms.size() / 2];
}

}  // namespace

Own measure_own(const MadeStudy& study, const std::vector<std::vector<TickRecord>>& made) {
    Own own;
    measure_schema(own);
    const std::int64_t period_ns = 1'000'000;
    double encode = 0.0;
    double decode = 0.0;
    std::size_t samples = 0;
    std::vector<ColumnId> trials;
    for (std::size_t i = 0; i < made.size(); ++i) {
        const auto& condition = study.plan.trials.at(kFirst + i).condition;
        std::unique_ptr<const engine::Scene> scene(
            new engine::Scene(make_scene(study.protocol, condition)));
        const auto start = Clock::now();
        Chunks chunks = encode_all(made[i], *scene, period_ns);
        encode += seconds_since(start);

        std::vector<std::int64_t> values(data::kChunkTicks);
        const auto before = Clock::now();
        for (const data::ChunkView& view : chunks.views) {
            read_stored(view, data::ColumnId::hip_x, std::span(values).first(view.ticks));
        }
        decode += seconds_since(before);
        trials.push_back({std::move(scene), std::move(chunks)});
        samples += made[i].size();
    }
    const double millions = 1e-6 * static_cast<double>(samples);
    own.encode = millions / encode;
    own.decode = millions / decode;
    own.replay = kTimes * millions / seconds_side_by_side(trials);
    own.replay_one = kTimes * millions / seconds_one_by_one(trials);
    return own;
}

}  // namespace palpate::bench
