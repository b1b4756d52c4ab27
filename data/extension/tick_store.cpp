#include "data/extension/tick_store.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "data/extension/part_chunks.hpp"
#include "data/extension/query.hpp"
#include "data/extension/stored_blocks.hpp"
#include "data/trace/chunk.hpp"
#include "data/trace/replay.hpp"

namespace palpate::data {

using engine::TickRecord;

namespace {

/// What follows from the hand's path from tick 0 on: the whole part in one block.
class ReplayedBlocks : public TickBlocks {
public:
    ReplayedBlocks(std::shared_ptr<const std::vector<TickRecord>> ticks, const TickRange& range)
        : ticks_(std::move(ticks)), left_(ticks_in(*ticks_, range)) {}
    std::span<const TickRecord> next() override { return std::exchange(left_, {}); }

private:
    std::shared_ptr<const std::vector<TickRecord>> ticks_;
    std::span<const TickRecord> left_;
};

}  // namespace

struct TickStore::State {
    explicit State(sqlite3* database) : db(database) {}

    struct Context {
        TraceTrial trial;
        SessionTraces* session = nullptr;
    };
    Context context_of(const TrialPart& part);
    std::shared_ptr<const std::vector<TickRecord>> replayed(const TrialPart& part, bool closest);
    void make_room();
    void require_one_study();

    sqlite3* db;
    /// By protocol and calibration, so that nothing here can be out of date.
    std::map<std::pair<std::string, std::string>, SessionTraces> sessions;
    struct Kept {
        TrialPart part;
        std::vector<std::vector<std::byte>> chunks;  ///< what it was made of
        bool closest = false;                        ///< with closest points
        std::shared_ptr<const std::vector<TickRecord>> ticks;
    };
    /// Last used last. A join asks for the same parts again and again: two trials of two intervals.
    std::vector<Kept> kept;
};

TickStore::State::Context TickStore::State::context_of(const TrialPart& part) {
    Query row(db,
              "SELECT coalesce(felt.felt_object, plan.planned_object), coalesce(felt.friction, "
              "plan.friction), coalesce(felt.slip_decay, 0), "
              "coalesce(felt.heal_decay, 0), felt.curvature_per_m, felt.mu_s, "
              "felt.mu_d, study.protocol_toml, (SELECT value FROM main.session_provenance AS p "
              "WHERE p.session_id = session.session_id AND p.key = 'calibration') FROM main.trial "
              "JOIN main.plan USING (session_id, plan_position) JOIN main.session USING "
              "(session_id) JOIN main.study USING (study_id) LEFT JOIN main.presentation AS felt "
              "ON felt.trial_id = trial.trial_id AND felt.interval = ?2 WHERE trial.trial_id = ?1");
    if (!row.bind(1, part.trial).bind(2, part.interval).step()) {
        fail(part, "it has ticks, but no row in trial");
    }
    const auto number = [&row](int column) {
        return row.null(column) ? std::nullopt : std::optional(row.real(column));
    };
    const std::pair key(row.text(7), row.text(8));
    auto session = sessions.find(key);
    if (session == sessions.end()) {
        session = sessions.emplace(key, SessionTraces(key.first, key.second)).first;
    }
    return {.trial = {.object = row.text(0),
                      .friction = row.text(1),
                      .slip_decay = row.real(2),
                      .heal_decay = row.real(3),
                      .curvature = number(4),
                      .mu_s = number(5),
                      .mu_d = number(6)},
            .session = &session->second};
}

std::shared_ptr<const std::vector<TickRecord>> TickStore::State::replayed(const TrialPart& part,
                                                                          bool closest) {
    PartChunks rows(db, part);
    std::vector<std::vector<std::byte>> bytes;
    std::vector<ChunkView> views;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        PartChunk chunk = rows.at(i);
        views.push_back(chunk.view);
        bytes.push_back(std::move(chunk.bytes));  // the view looks at the same bytes
    }
    const auto same = std::ranges::find_if(kept, [&](const Kept& one) {
        return one.part == part && one.closest >= closest && one.chunks == bytes;
    });
    if (same != kept.end()) {
        std::rotate(same, same + 1, kept.end());
        return kept.back().ticks;
    }
    make_room();
    const Context context = context_of(part);
    Replayed all = context.session->replay(context.trial, views);
    if (all.differs_from) {
        throw SampleError(replay_sentence(part.trial, *all.differs_from));
    }
    if (closest) {
        find_closest_points(context.session->scene_of(context.trial), all.ticks);
    }
    kept.push_back(
        {.part = part,
         .chunks = std::move(bytes),
         .closest = closest,
         .ticks = std::make_shared<const std::vector<TickRecord>>(std::move(all.ticks))});
    return kept.back().ticks;
}

/// For one more: of a long trial none is kept beside it.
void TickStore::State::make_room() {
    constexpr std::size_t kMostParts = 4;
    constexpr std::size_t kMostTicks = 400'000;  // 60 MB
    const auto ticks = [this] {
        std::size_t sum = 0;
        for (const Kept& one : kept) {
            sum += one.ticks->size();
        }
        return sum;
    };
    while (kept.size() >= kMostParts || ticks() > kMostTicks) {
        kept.erase(kept.begin());
    }
}

TickStore::TickStore(sqlite3* db) : state_(std::make_unique<State>(db)) {}
TickStore::~TickStore() = default;

/// SQLite does not tell a table of this kind which database was named: b.sample would be main's ticks.
void TickStore::State::require_one_study() {
    Query others(db,
                 "SELECT d.name FROM pragma_database_list AS d WHERE d.name NOT IN ('main', 'temp')"
                 " AND EXISTS (SELECT 1 FROM pragma_table_info('trace_chunk', d.name))");
    if (others.step()) {
        throw SampleError(fmt::format(
            "sample is of the file that was opened first, and another palpate database is "
            "attached: DETACH {}, and ask each by itself",
            others.text(0)));
    }
}

std::vector<TrialPart> TickStore::parts(const TrialRange& trials) {
    state_->require_one_study();
    // A part whose chunks are gone is one too: it is refused.
    std::vector<TrialPart> parts;
    Query query(state_->db,
                "SELECT trial_id, interval FROM main.trace_chunk WHERE trial_id BETWEEN ?1 AND ?2 "
                "UNION SELECT trial_id, interval FROM main.presentation WHERE trial_id BETWEEN ?1 "
                "AND ?2 AND ticks > 0 ORDER BY 1, 2");
    query.bind(1, trials.first).bind(2, trials.last);
    while (query.step()) {
        parts.push_back({.trial = query.integer(0), .interval = query.integer(1)});
    }
    return parts;
}

std::unique_ptr<TickBlocks> TickStore::blocks(const TrialPart& part,
                                              SampleColumns columns,
                                              const TickRange& range) {
    State& state = *state_;
    if ((columns & kReplayedColumns) != 0) {
        const bool closest = (columns & kClosestColumns) != 0;
        return std::make_unique<ReplayedBlocks>(
            of_part(part, [&] { return state.replayed(part, closest); }), range);
    }
    std::optional<engine::PantographSpec> machine;
    if ((columns & kHipColumns) != 0) {
        machine = of_part(part, [&] { return state.context_of(part).session->machine(); });
    }
    return stored_blocks(state.db, part, columns, range, machine);
}

}  // namespace palpate::data
