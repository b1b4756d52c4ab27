#pragma once

#include "data/store/people.hpp"
#include "tests/support/sql_first.hpp"
#include "tests/support/studies.hpp"

/// Rigs whose files are to be merged.
namespace palpate::tests {

/// A rig that runs sessions step by step.
class Rig {
public:
    Rig(std::string file, std::string participant, std::size_t number, bool other_study = false)
        : file_(std::move(file)) {
        protocols::Protocol protocol = small_protocol();
        protocol.title = other_study ? "The same name, another text" : protocol.title;
        spec_ = session_spec(protocol, std::move(participant), number);
        spec_.kind = data::RunKind::real;
        data::Database database(file_, data::Access::write);
        session_ = data::open_session(database, spec_).id;
    }

    /// Something that happens in a session.
    void step(Random& random) {
        data::Database database(file_, data::Access::write);
        auto row = database.prepare(
            "SELECT trial_id, outcome FROM trial WHERE session_id = ?1 ORDER BY trial_id DESC",
            session_);
        const bool any = row.step();
        const std::int64_t last = any ? row.integer(0) : 0;
        const bool runs = any && row.text(1) == "running";
        row.reset();
        if (runs) {
            random.coin() ? chunk(database, last, random) : end(database, last, random);
        } else if (any && random.below(4) == 0) {
            mark(database, last);
        } else if (random.below(5) == 0) {
            data::add_note(database, session_, fmt::format("note {}", random.below(1000)));
        } else {
            begin(database, random);
        }
        database.checkpoint();
    }

    void finish() {
        data::Database database(file_, data::Access::write);
        data::SqliteRecorder(database, spec_.protocol, session_).finish_session();
    }

    [[nodiscard]] const std::string& file() const { return file_; }

private:
    void begin(data::Database& database, Random& random) {
        database.run(
            "INSERT INTO trial (device, session_id, plan_position, attempt, outcome, started_utc) "
            "SELECT 'test', ?1, ?2, 1 + count(*), 'running', ?3 FROM trial WHERE session_id = ?1 "
            "AND plan_position = ?2",
            session_, random.below(6), data::utc_now());
    }
    void chunk(data::Database& database, std::int64_t trial, Random& random) {
        const std::vector<std::byte> bytes(static_cast<std::size_t>(1 + random.below(40)),
                                           static_cast<std::byte>(random.below(256)));
        database.run(
            "INSERT INTO trace_chunk (trial_id, interval, first_tick, ticks, codec, period_ns, "
            "holds, crc32, derived, data) SELECT ?1, 1, coalesce(max(first_tick), -256) + 256, "
            "256, 1, 1000000, '', 0, 0, ?2 FROM trace_chunk WHERE trial_id = ?1",
            trial, std::span<const std::byte>(bytes));
    }
    void end(data::Database& database, std::int64_t trial, Random& random) {
        const bool answered = random.below(4) != 0;
        database.run(
            "UPDATE trial SET outcome = ?2, done_s = ?3, ended_utc = ?4 WHERE trial_id = ?1", trial,
            std::string_view(answered ? "complete" : "aborted"), random.in(0.0, 9.0),
            data::utc_now());
        if (answered) {
            database.run(
                "INSERT INTO response (trial_id, chosen_place, chosen_object, correct, reaction_s, "
                "reaction_uncertainty_s, input, answer_code) VALUES (?1, 0, 'straight', 1, ?2, "
                "0.0, 'key', 0)",
                trial, random.in(0.1, 3.0));
        }
        data::chain_trial(database, trial);
    }
    void mark(data::Database& database, std::int64_t trial) {
        try {
            data::mark_invalid(database, trial, {"talked meanwhile"});
        } catch (const std::invalid_argument&) {  // it has no answer, or is marked already
        }
    }

    std::string file_;
    data::SessionSpec spec_;
    std::int64_t session_ = 0;
};

/// Rigs that went through random steps, and copies of their files from in between.
struct MergeWorld {
    explicit MergeWorld(std::uint64_t seed) : random(seed) {
        rigs.emplace_back(folder.file("a.sqlite"), "P01", 1);
        rigs.emplace_back(folder.file("a.sqlite"), "P02", 1);
        rigs.emplace_back(folder.file("b.sqlite"), "P03", 1);
        rigs.emplace_back(folder.file("b.sqlite"), "P01", 2);
        rigs.emplace_back(folder.file("c.sqlite"), "P01", 1, true);
        for (int i = 0; i < 60; ++i) {
            Rig& rig = rigs[random.index(5)];
            rig.step(random);
            if (random.below(8) == 0) {
                files.push_back(copied(rig.file(), folder.file(fmt::format("copy{}.sqlite", i))));
            }
        }
        if (random.coin()) {
            rigs.front().finish();
        }
        for (const char* name : {"a.sqlite", "b.sqlite", "c.sqlite"}) {
            last.push_back(folder.file(name));
            files.push_back(last.back());
        }
    }
    TemporaryFolder folder;
    Random random;
    std::vector<Rig> rigs;
    Words files;  ///< all moments
    Words last;   ///< what became of them
};

}  // namespace palpate::tests
