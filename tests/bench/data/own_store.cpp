#include "tests/bench/data/own_store.hpp"

#include "engine/base/side_by_side.hpp"
#include "protocols/design/session_plan.hpp"
#include "protocols/file/calibration_file.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/library/shipped.hpp"
#include "protocols/trial/servo_apparatus.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "data/extension/sample_module.hpp"
#include "data/store/own_schema.hpp"
#include "data/store/session_store.hpp"
#include "data/store/sqlite_recorder.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/replay.hpp"
#include "data/verify/verify.hpp"
#include "tests/support/scenes.hpp"

namespace palpate::bench {

namespace {

constexpr double kMeanLateness = 8000.0;  // ns

void pop_all(engine::TickRing& ring, std::vector<engine::TickRecord>& ticks) {
    std::array<engine::TickRecord, 256> buffer{};
    while (const std::size_t n = ring.pop(buffer)) {
        ticks.insert(ticks.end(), buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(n));
    }
}

}  // namespace

MadeStudy made_study() {
    MadeStudy study;
    for (const protocols::ShippedProtocol& shipped : protocols::shipped_protocols()) {
        if (shipped.name == "shape_friction") {
            study.protocol = protocols::parse_protocol(shipped.text, "shape_friction");
        }
    }
    study.hash = protocols::protocol_hash(study.protocol);
    study.key = {.participant = "bench", .secret = std::string(32, 'b')};
    study.plan = make_plan(study.protocol, study.hash, study.key, study.protocol.seed);
    return study;
}

std::vector<engine::TickRecord> made_trial(const MadeStudy& study,
                                           std::size_t position,
                                           double seconds) {
    const protocols::Protocol& protocol = study.protocol;
    const protocols::PlannedTrial& planned = study.plan.trials.at(position);
    engine::SimulatedPantograph device({}, 1.0 / protocol.apparatus.rate_hz);
    engine::VirtualServo servo(device, protocols::servo_spec(protocol, device));
    engine::Exploration hand =
        protocols::DrawnHand(protocol, study.hash, study.key, protocol.seed).at(position);
    hand.sweeps = static_cast<int>(seconds);  // each takes more than a second
    const engine::Scene scene = make_scene(protocol, planned.condition);
    device.begin(hand);
    servo.begin(scene);
    std::vector<engine::TickRecord> ticks;
    while (servo.elapsed_s() < seconds && servo.advance() == engine::ServoStatus::running) {
        pop_all(servo.ring(), ticks);
    }
    servo.end();
    pop_all(servo.ring(), ticks);
    Pcg32 random = protocols::stream({.protocol_hash = study.hash,
                                      .participant = "bench",
                                      .block = position,
                                      .purpose = "lateness",
                                      .seed = 1});
    for (engine::TickRecord& tick : ticks) {
        const double share = (static_cast<double>(random.next()) + 0.5) * 0x1p-32;
        tick.lateness_us = static_cast<float>(std::floor(-kMeanLateness * std::log(share)) * 1e-3);
    }
    return ticks;
}
namespace {

using engine::TickRecord;

constexpr std::size_t kFirst = 10;  ///< position of the first made trial: after practice
constexpr std::size_t kMade = 10;

engine::Calibration simulated_machine() {
    return {.pantograph = engine::PantographModel{}.plant.machine};
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
    [[nodiscard]] std::size_t verify() override {
        data::Database file(file_, data::Access::read);
        return static_cast<std::size_t>(data::verify(file).sessions.at(0).replayed);
    }

private:
    [[nodiscard]] double value(const std::string& sql) { return database_.first(sql).real(0); }

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
        std::vector<std::uint8_t> each(part.size());
        retrace.parts(part, each);
        const std::uint8_t parts =
            std::accumulate(each.begin(), each.end(), std::uint8_t{0}, std::bit_or<std::uint8_t>());
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

/// A made trial as it is stored, and what it is replayed with.
struct StoredTrial {
    std::unique_ptr<const engine::Scene> scene;
    Chunks chunks;
};

void replay(const StoredTrial& trial, bool helped) {
    const data::ReplayResult again =
        data::replay(trial.scene.get(), simulated_machine().pantograph, trial.chunks.views, helped);
    if (again.differs_from) {
        throw std::runtime_error("the replay differs from what was made");
    }
}

void replay_side_by_side(const std::vector<StoredTrial>& trials, int cores) {
    SideBySide work(static_cast<std::size_t>(cores));
    std::size_t last = 0;
    for (const StoredTrial& trial : trials) {
        last = work.add([&trial] { replay(trial, false); });
    }
    for (std::size_t i = 0; i <= last; ++i) {
        work.wait_for(i);
    }
}

/// Time of the processor, since less than a millisecond is soon lost to another program. The first
/// comparison in a program reads the catalogue too, so this comes before any file is opened.
void measure_schema(std::vector<Figure>& figures) {
    const data::Database database("schema", data::Access::memory);
    const Stopwatch processor;
    std::vector<double> ms;
    for (int i = 0; i < 201; ++i) {
        ms.push_back(1e3 * processor.seconds([&] {
            if (!data::schema_differences(database.connection()).empty()) {
                throw std::runtime_error("a new file's schema differs from the catalogue");
            }
        }));
    }
    figures.push_back({"schema at open, the first", "ms", median({ms.front()})});
    figures.push_back({"schema at open, again", "ms", median({ms.begin() + 1, ms.end()})});
}

}  // namespace

std::vector<Figure> measure_own(const MadeStudy& study,
                                const std::vector<std::vector<TickRecord>>& made,
                                const Stopwatch& watch) {
    constexpr int kRounds = 11;
    constexpr std::int64_t kPeriod = 1'000'000;  // ns
    std::vector<Figure> figures;
    measure_schema(figures);
    double millions = 0.0;
    std::vector<double> simulate;
    std::vector<double> encode;
    std::vector<double> decode;
    std::vector<StoredTrial> trials;
    for (std::size_t i = 0; i < made.size(); ++i) {
        const double each = 1e-6 * static_cast<double>(made[i].size());
        const double long_s =
            static_cast<double>(kPeriod) * 1e-9 * static_cast<double>(made[i].size());
        simulate.push_back(each / watch.seconds([&] {
            static_cast<void>(made_trial(study, kFirst + i, long_s));
        }));
        const auto& condition = study.plan.trials.at(kFirst + i).condition;
        std::unique_ptr<const engine::Scene> scene(
            new engine::Scene(make_scene(study.protocol, condition)));
        Chunks chunks;
        encode.push_back(each /
                         watch.seconds([&] { chunks = encode_all(made[i], *scene, kPeriod); }));
        std::vector<std::int64_t> values(data::kChunkTicks);
        decode.push_back(each / watch.seconds([&] {
            for (const data::ChunkView& view : chunks.views) {
                data::ChunkReader(view).read(data::ColumnId::hip_x,
                                             std::span(values).first(view.ticks));
            }
        }));
        trials.push_back({std::move(scene), std::move(chunks)});
        millions += each;
    }
    std::vector<double> side_by_side;
    std::vector<double> one_by_one;
    for (int i = 0; i < kRounds; ++i) {
        side_by_side.push_back(millions /
                               watch.seconds([&] { replay_side_by_side(trials, watch.cores); }));
        one_by_one.push_back(millions / watch.seconds([&] {
            for (const StoredTrial& trial : trials) {
                replay(trial, watch.cores > 1);
            }
        }));
    }
    const char* unit = "million samples/s";
    figures.push_back({"simulate", unit, median(simulate)});
    figures.push_back({"encode", unit, median(encode)});
    figures.push_back({"decode of one stored column", unit, median(decode)});
    figures.push_back({"replay, trials side by side", unit, median(side_by_side)});
    figures.push_back({"replay, one trial after the other", unit, median(one_by_one)});
    return figures;
}

}  // namespace palpate::bench
