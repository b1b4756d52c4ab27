#include "tests/support/studies.hpp"

#include "protocols/design/session_plan.hpp"
#include "protocols/file/protocol_file.hpp"
#include "protocols/trial/object_hash.hpp"
#include "data/store/reader.hpp"

namespace palpate::tests {

protocols::Protocol small_protocol(std::size_t repetitions) {
    protocols::Protocol protocol;
    protocol.id = "small";
    protocol.title = "A small study";
    protocol.seed = 7;
    protocol.objects = {{"concave", -8.0, true}, {"straight", 0.0, true}, {"convex", 8.0, true}};
    protocol.frictions = {
        {.name = "off"},
        {.name = "on", .law = "gos", .mu_s = 0.7, .mu_d = 0.5, .tau_slip = 0.02, .tau_heal = 0.1}};
    protocol.design = {.repetitions = repetitions,
                       .max_run_object = 2,
                       .max_run_friction = 3,
                       .practice_repetitions = 0,
                       .catch_trials = 0,
                       .break_every = 0};
    protocol.timing.gap = 0.0;
    return protocol;
}

data::SessionSpec session_spec(const protocols::Protocol& protocol,
                               std::string participant,
                               std::size_t number) {
    data::SessionSpec spec;
    spec.protocol = protocol;
    spec.protocol_hash = protocols::protocol_hash(protocol);
    spec.key = {std::move(participant), number, kSecret};
    spec.seed = protocol.seed;
    spec.plan = protocols::make_plan(protocol, spec.protocol_hash, spec.key, spec.seed);
    spec.device = "test";
    spec.provenance = protocols::object_hashes(protocol);
    return spec;
}

std::vector<engine::TickRecord> random_ticks(std::uint64_t seed,
                                             std::size_t count,
                                             std::int64_t first) {
    Random random(seed);
    const auto bits = [&random] {
        std::uint64_t word = 0;
        for (int i = 0; i < 4; ++i) {
            word = (word << 16U) | static_cast<std::uint64_t>(random.below(65536));
        }
        double value = 0.0;
        std::memcpy(&value, &word, sizeof value);
        return random.coin() ? value : random.in(-1.0, 1.0);
    };
    std::vector<engine::TickRecord> ticks(count);
    for (std::size_t i = 0; i < count; ++i) {
        engine::TickRecord& t = ticks[i];
        t.tick = first + static_cast<std::int64_t>(i);
        t.time_ns = t.tick * 1'000'000;
        for (engine::Vec3* v : {&t.hip, &t.go, &t.force, &t.command}) {
            *v = engine::Vec3{bits(), bits(), bits()};
        }
        t.normal_force = bits();
        t.tangential_force = bits();
        t.mu = bits();
        t.u = bits();
        t.v = bits();
        t.counts = {random.below(1 << 20) - (1 << 19), random.below(100),
                    random.below(1 << 20) - (1 << 19)};
        t.codes = {random.below(65536) - 32768, random.below(100), random.below(65536) - 32768};
        t.lateness_us = static_cast<float>(random.in(0.0, 50.0));
        t.segment = static_cast<std::int16_t>(random.below(6) - 3);
        t.mode = static_cast<engine::Mode>(random.below(4));
        t.flags = static_cast<std::uint8_t>(random.below(16));
    }
    return ticks;
}

bool same_bits(const engine::TickRecord& a, const engine::TickRecord& b) {
    const auto equal = [](const auto& x, const auto& y) {
        return std::memcmp(&x, &y, sizeof x) == 0;
    };
    return a.tick == b.tick && a.time_ns == b.time_ns && equal(a.hip, b.hip) && equal(a.go, b.go) &&
           equal(a.force, b.force) && equal(a.command, b.command) &&
           equal(a.normal_force, b.normal_force) && equal(a.tangential_force, b.tangential_force) &&
           equal(a.mu, b.mu) && equal(a.u, b.u) && a.counts == b.counts && a.codes == b.codes &&
           equal(a.lateness_us, b.lateness_us) && a.segment == b.segment && a.mode == b.mode &&
           a.flags == b.flags && equal(a.v, b.v);
}

protocols::TrialId begin_trial(protocols::Recorder& recorder,
                               const protocols::Protocol& protocol,
                               const protocols::PlannedTrial& planned,
                               const protocols::SceneConstants& scene) {
    const protocols::TrialId id = recorder.begin_trial(planned);
    recorder.begin_interval(id, protocols::presentations_of(protocol, planned).front(), scene);
    return id;
}

protocols::TrialResult answered(std::size_t object, bool correct, std::int64_t ticks) {
    protocols::TrialResult result;
    result.done_s = 3.0;
    result.summary.ticks = ticks;
    result.intervals = {{.done_s = result.done_s, .summary = result.summary}};
    result.response = protocols::Response{{.place = object, .reaction_s = 1.0}, object, correct};
    return result;
}

std::string lines(data::Database& database, const std::string& sql) {
    auto row = database.prepare(sql);
    std::string text;
    while (row.step()) {
        for (int i = 0; i < row.columns(); ++i) {
            text += row.text(i) + ' ';
        }
        text += '\n';
    }
    return text;
}

std::int64_t count(data::Database& database, const std::string& from) {
    return database.first("SELECT count(*) FROM " + from).integer(0);
}

std::string text_of(const data::Verification& found, bool missing) {
    std::string text;
    const auto add = [&](const std::vector<data::Finding>& findings) {
        for (const data::Finding& one : findings) {
            if (missing || one.kind != data::FindingKind::missing) {
                text += fmt::format("{} {}: {} | {}\n", one.trial.value_or(0), one.what, one.stored,
                                    one.recomputed);
            }
        }
    };
    add(found.file);
    for (const auto& session : found.sessions) {
        add(session.findings);
    }
    return text;
}

std::string differences(data::Database& database) {
    return text_of(data::verify(database), false);
}

namespace {

/// The hash of hashes: each row's text is hashed, the sum hashes the list.
class Content {
public:
    void line(const std::string& text) { all_ += sha256_hex(text) + '\n'; }
    [[nodiscard]] std::string hash() const { return sha256_hex(all_); }

private:
    std::string all_;
};

Words tables(data::Database& database) {
    return texts(database.prepare(
        "SELECT name FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%' AND name "
        "NOT IN ('session_provenance', 'trace_chunk', 'secret') ORDER BY name"));
}

/// From run to run, though nothing else differs.
bool varies(std::string_view column) {
    return column.ends_with("_utc") || column == "at_ns" || column == "started_ns" ||
           column == "uuid" || column == "seal" || column == "newest_seal";
}

void add_table(data::Database& database, const std::string& table, Content& content) {
    // The first two columns are a key in every table, or begin with one.
    for (const data::Statement& row :
         database.prepare(fmt::format("SELECT * FROM {} ORDER BY 1, 2", table))) {
        std::string text = table + ':';
        for (int column = 0; column < row.columns(); ++column) {
            if (!varies(row.name(column))) {
                const std::string value =
                    row.type(column) == 2 ? fmt::format("{}", row.real(column)) : row.text(column);
                text += fmt::format("{}:{}:{};", row.type(column), value.size(), value);
            }
        }
        content.line(text);
    }
}

/// Columns one after the other, bytes shuffled within each.
std::string shuffled_columns(std::span<const engine::TickRecord> ticks) {
    std::string raw;
    for (const data::TraceColumn& column : data::trace_columns()) {
        for (std::size_t byte = 0; byte < column.size; ++byte) {
            for (const engine::TickRecord& tick : ticks) {
                raw += reinterpret_cast<const char*>(&tick)[column.offset + byte];
            }
        }
    }
    return raw;
}

void add_traces(data::Database& database, Content& content) {
    std::vector<std::pair<std::int64_t, std::int64_t>> intervals;
    for (const data::Statement& row :
         database.prepare("SELECT trial_id, interval FROM presentation ORDER BY 1, 2")) {
        intervals.emplace_back(row.integer(0), row.integer(1));
    }
    data::TraceReader traces(database);
    for (const auto& [trial, interval] : intervals) {
        content.line(fmt::format("trace {} {} ", trial, interval) +
                     shuffled_columns(traces.stored(trial, interval)));
    }
}

}  // namespace

std::string content_hash(data::Database& database) {
    const data::Snapshot now(database);
    Content content;
    for (const std::string& table : tables(database)) {
        add_table(database, table, content);
    }
    add_traces(database, content);
    return content.hash();
}

}  // namespace palpate::tests
