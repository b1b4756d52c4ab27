#include "data/sync/merge.hpp"
#include "tests/support/database_edits.hpp"
#include "tests/support/merge_world.hpp"
#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

using namespace palpate::data;

namespace {

/// Everything that a file says of sessions and people, row by row, without the ids that are its
/// own.
std::string content_of(const std::string& file) {
    Database database(file, Access::read);
    std::string all;
    for (const std::string& sql : lines_in(test_text("edits/all_of_a_file.sql"))) {
        for (const auto& row : database.prepare(sql)) {
            for (int column = 0; column < row.columns(); ++column) {
                all +=
                    row.type(column) == 2 ? fmt::format("{}", row.real(column)) : row.text(column);
                all += row.null(column) ? "NULL|" : "|";
            }
            all += '\n';
        }
    }
    return all;
}

void shuffle(Words& files, Random& random) {
    for (std::size_t i = files.size(); i > 1; --i) {
        std::swap(files[i - 1], files[random.index(i)]);
    }
}

}  // namespace

TEST_CASE(
    "files merged in any order, at once or one by one, again or in part before, give the same "
    "content",
    "[long]") {
    SEED(5U);
    MergeWorld world(seed);
    const std::string whole = world.folder.file("whole.sqlite");
    REQUIRE(data::merge_files(whole, world.last).conflicts.empty());
    const std::string expected = content_of(whole);

    Words some = world.files;
    shuffle(some, world.random);
    const std::string once = world.folder.file("once.sqlite");
    const MergeReport all = data::merge_files(once, some);
    CHECK(all.conflicts.empty());
    CHECK(all.added == 5);
    CHECK(content_of(once) == expected);

    shuffle(some, world.random);
    const std::string stepwise = world.folder.file("stepwise.sqlite");
    for (const std::string& file : some) {
        CHECK(data::merge_files(stepwise, {file}).conflicts.empty());
    }
    CHECK(content_of(stepwise) == expected);

    const MergeReport again = data::merge_files(stepwise, some);
    CHECK(again.added == 0);
    CHECK(again.extended == 0);
    CHECK(again.same == 5);
    CHECK(content_of(stepwise) == expected);
}

TEST_CASE("a session that was damaged or edited is named, and nothing of it is merged") {
    for (const auto& [table, column] :
         {std::pair{"response", "reaction_s"}, std::pair{"trial", "done_s"},
          std::pair{"trace_chunk", "data"}, std::pair{"plan", "mu_s"}, std::pair{"event", "text"},
          std::pair{"session", "device"}, std::pair{"participant", "participant_code"}}) {
        CAPTURE(table, column);
        MergeWorld world(7);
        const std::string damaged = world.rigs.front().file();
        const auto sessions = [](const std::string& file) {
            Database database(file, Access::read);
            return database.first("SELECT count(*) FROM session").integer(0);
        };
        const std::int64_t all = sessions(damaged);
        {
            Database database(damaged, Access::write);
            edit(database, table, column, a_row(database, table, world.random), world.random);
        }
        const std::string out = world.folder.file("out.sqlite");
        const MergeReport report = data::merge_files(out, {damaged});
        REQUIRE(report.conflicts.size() == 1);
        CHECK_THAT(report.conflicts.front().what, Has("palpate verify"));
        CHECK(report.conflicts.front().first == damaged);
        CHECK(sessions(out) == all - 1);
    }
}

TEST_CASE("a trial keeps its id when its session goes on") {
    SEED(3U);
    MergeWorld world(seed);
    const std::string out = world.folder.file("out.sqlite");
    std::map<std::string, std::int64_t> ids;
    for (const std::string& file : world.files) {
        (void)data::merge_files(out, {file});
        Database database(out, Access::read);
        for (const auto& row :
             database.prepare("SELECT uuid || plan_position || '.' || attempt, trial.trial_id FROM "
                              "trial JOIN session USING (session_id)")) {
            const auto [there, is_new] = ids.emplace(row.text(0), row.integer(1));
            CHECK(there->second == row.integer(1));
        }
    }
}

TEST_CASE(
    "a session that two files tell differently is named with both, and nothing of it is merged") {
    EACH(column, "session SET device = 'other'", "plan SET mu_s = mu_s + 1",
         "trial SET done_s = 99.0", "trial SET plan_position = 5", "response SET reaction_s = 99.0",
         "trace_chunk SET data = x'00'", "event SET text = 'other'",
         "session SET finished_utc = '2026'", "trial SET invalid_reason = 'other'");
    const TemporaryFolder folder;
    Random random(3);
    Rig rig(folder.file("a.sqlite"), "P01", 1);
    {
        Database database(rig.file(), Access::write);
        database.execute(
            "INSERT INTO trial (device, session_id, plan_position, attempt, outcome, started_utc, "
            "done_s, invalid_reason) VALUES ('test', 1, 0, 1, 'complete', '2026', 1.0, "
            "'talked');INSERT INTO response (trial_id, chosen_place, chosen_object, correct, "
            "reaction_s, reaction_uncertainty_s, input, answer_code) VALUES (1, 0, 'straight', 1, "
            "1.0, 0.0, 'key', 0);INSERT INTO trace_chunk (trial_id, interval, first_tick, ticks, "
            "codec, period_ns, holds, crc32, derived, data) VALUES (1, 1, 0, 1, 1, 1000000, '', 0, "
            "0, x'0102');");
        data::add_note(database, 1, "a note");
        database.checkpoint();
    }
    rig.finish();
    const std::string other = copied(rig.file(), folder.file("copy.sqlite"));
    sql_edit(other, fmt::format("UPDATE {}", column));
    const Rig third(folder.file("c.sqlite"), "P07", 1);

    const std::string out = folder.file("out.sqlite");
    const MergeReport report = data::merge_files(out, {rig.file(), other, third.file()});
    REQUIRE(report.conflicts.size() == 1);
    CHECK(report.conflicts[0].first == rig.file());
    CHECK(report.conflicts[0].second == other);
    CHECK_THAT(report.conflicts[0].what, Has("P01"));
    CHECK(report.added == 1);
    CHECK(sql_first(out,
                    "SELECT group_concat(participant_code) FROM session JOIN participant USING "
                    "(participant_id)") == "P07");
}

TEST_CASE("of a session that two files tell differently the preferred file's is taken") {
    const TemporaryFolder folder;
    const Rig rig(folder.file("a.sqlite"), "P01", 1);
    const std::string other = copied(rig.file(), folder.file("copy.sqlite"));
    for (const std::string& file : {rig.file(), other}) {
        Database database(file, Access::write);
        data::add_note(database, 1, "said in " + file);
        database.checkpoint();
    }
    for (const std::string& preferred : {rig.file(), other}) {
        for (const std::string& first : {rig.file(), other}) {
            const std::string out = folder.file("out.sqlite");
            const std::string second = first == other ? rig.file() : other;
            CHECK(data::merge_files(out, {first, second}).added == 0);
            CHECK(data::merge_files(out, {first, second}, preferred).conflicts.empty());
            CHECK(content_of(out) == content_of(preferred));
            std::filesystem::remove(out);
        }
    }
}

TEST_CASE(
    "one study, participant and number under two uuids is a conflict, and what was there stays") {
    const TemporaryFolder folder;
    const Rig a(folder.file("a.sqlite"), "P01", 1);
    const Rig b(folder.file("b.sqlite"), "P01", 1);
    const std::string out = folder.file("out.sqlite");
    CHECK(data::merge_files(out, {a.file(), b.file()}).conflicts.size() == 1);
    CHECK(content_of(out).find("small") == std::string::npos);
    CHECK(data::merge_files(out, {a.file()}).added == 1);
    const std::string before = content_of(out);
    CHECK(data::merge_files(out, {b.file()}).conflicts.size() == 1);
    CHECK(content_of(out) == before);
}

TEST_CASE(
    "what one file knows of a participant fills what the other does not, of two notes the newest "
    "is kept, and of one time they are a conflict") {
    const TemporaryFolder folder;
    const Rig a(folder.file("a.sqlite"), "P01", 1);
    const Rig b(folder.file("b.sqlite"), "P01", 2);
    const auto note = [](const Rig& rig, const data::ParticipantNotes& notes) {
        Database database(rig.file(), Access::write);
        data::note_participant(database, "P01", notes);
    };
    note(a, {.handedness = 80, .details = {{"age", "30"}}});
    note(b, {.consent = true, .details = {{"gender", "x"}}});
    const std::string out = folder.file("out.sqlite");
    REQUIRE(data::merge_files(out, {a.file(), b.file()}).conflicts.empty());
    Database database(out, Access::read);
    const auto known = data::find_participant(database, "P01");
    REQUIRE(known);
    CHECK(known->notes.handedness == 80);
    CHECK(known->notes.consent == true);
    CHECK(known->notes.details.size() == 2);

    const auto notes = GENERATE(data::ParticipantNotes{.handedness = -80},
                                data::ParticipantNotes{.details = {{"age", "31"}}});
    note(b, notes);
    const MergeReport newest =
        data::merge_files(folder.file("newest.sqlite"), {b.file(), a.file()});
    CHECK(newest.conflicts.empty());
    CHECK(newest.notices.size() == 1);
    CHECK(newest.added == 2);
    for (const Rig* rig : {&a, &b}) {
        sql_edit(rig->file(),
                 "UPDATE participant SET handedness_utc = '2026-01-01T00:00:00.000Z'; UPDATE "
                 "participant_detail SET noted_utc = '2026-01-01T00:00:00.000Z'");
    }
    const std::string none = folder.file("none.sqlite");
    const MergeReport report = data::merge_files(none, {b.file(), a.file()});
    CHECK(report.conflicts.size() == 1);
    CHECK(report.added == 0);
    for (const Rig* right : {&a, &b}) {  // of one time: the file that is preferred is right
        const std::string file = folder.file(right == &a ? "as_a.sqlite" : "as_b.sqlite");
        CHECK(data::merge_files(file, {b.file(), a.file()}, right->file()).added == 2);
        const auto notes_of = [](const std::string& of) {
            Database one(of, Access::read);
            const auto person = data::find_participant(one, "P01");
            return std::pair(person->notes.handedness, person->notes.details);
        };
        const auto [handedness, details] = notes_of(file);
        const auto [said_handedness, said_details] = notes_of(right->file());
        CHECK((!said_handedness || handedness == said_handedness));
        for (const auto& detail : said_details) {
            CHECK(std::ranges::find(details, detail) != details.end());
        }
    }
}

TEST_CASE("every row of every table arrives in a merged file") {
    MergeWorld world(99);
    const std::string out = world.folder.file("out.sqlite");
    (void)data::merge_files(out, world.last);
    Database merged(out, Access::read);
    for (const auto& tables : merged.prepare(
             "SELECT name FROM sqlite_schema WHERE type = 'table' AND name NOT LIKE 'sqlite_%' AND "
             "name NOT IN ('study', 'participant', 'secret', 'trace_column')")) {
        const auto rows = [&](const std::string& file) {
            Database database(file, Access::read);
            return database.first(fmt::format("SELECT count(*) FROM {}", tables.text(0)))
                .integer(0);
        };
        CAPTURE(tables.text(0));
        std::int64_t expected = 0;
        for (const std::string& file : world.last) {
            expected += rows(file);
        }
        CHECK(rows(out) == expected);
    }
}

TEST_CASE("verify finds nothing wrong in a file merged from rigs that ran and marked") {
    const TemporaryFolder folder;
    const auto run = [&folder](const char* participant, const char* file) {
        ran(run_words("shape_friction_demo", participant, folder.file(file), {"--headless"}));
    };
    run("P1", "a.sqlite");
    run("P2", "b.sqlite");
    run("P3", "b.sqlite");
    ran({"mark", folder.file("b.sqlite"), "12", "--invalid", "a bell"});
    const std::string out = folder.file("out.sqlite");
    ran({"merge", out, folder.file("b.sqlite"), folder.file("a.sqlite")});
    CHECK_THAT(ran({"verify", out}).out, Has("3 sessions"));
}

TEST_CASE("merges at once into a file that is not there bring what one after the other would") {
    const TemporaryFolder folder;
    Words files;  // each with a secret of its own
    for (const char who : {'1', '2', '3', '4'}) {
        files.push_back(folder.file(fmt::format("{}.sqlite", who)));
        ran(run_words("shape_friction_demo", {'P', who}, files.back(),
                      {"--headless", "--secret", std::string(32, who)}));
    }
    const std::string one = folder.file("one.sqlite");
    ran(joined({"merge", one}, files));
    const std::string expected = content_of(one);
    for (int round = 0; round < 8; ++round) {
        CAPTURE(round);
        const std::string together = folder.file(fmt::format("together{}.sqlite", round));
        std::vector<std::unique_ptr<Process>> merges;
        for (const std::string& file : files) {
            merges.push_back(
                std::make_unique<Process>(Words{palpate_program(), "merge", together, file}));
        }
        for (const auto& merge : merges) {
            ended(merge->wait());
        }
        CHECK(content_of(together) == expected);
        CHECK(Database(together, Access::read).first("SELECT count(*) FROM secret").integer(0) ==
              4);
    }
}
