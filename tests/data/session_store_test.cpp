#include "protocols/design/session_plan.hpp"
#include "protocols/session/trust.hpp"
#include "protocols/trial/object_hash.hpp"
#include "data/page/study.hpp"
#include "data/store/stored_progress.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::data;

namespace {

/// Two trials are answered, the third is aborted and begun again, and then the program dies.
std::int64_t answer_two_and_die(Database& database, const data::SessionSpec& spec) {
    const auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto id = begin_trial(recorder, spec.protocol, spec.plan.trials[i]);
        recorder.append(id, random_ticks(i, 300));
        recorder.end_trial(id, answered(0, false, 300));
    }
    protocols::TrialResult aborted;
    aborted.outcome = protocols::Outcome::aborted;
    recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[2]), aborted);
    const auto cut = begin_trial(recorder, spec.protocol, spec.plan.trials[2]);
    recorder.append(cut, random_ticks(9, 600));
    REQUIRE(recorder.save());
    return opened.id;
}

std::string outcomes(Database& database) {
    auto row = database.first(
        "SELECT group_concat(outcome), (SELECT count(*) FROM event) FROM trial ORDER BY trial_id");
    return row.text(0) + ", events " + row.text(1);
}

/// From its first trial on a session is what it was begun as.
void begin(Database& database, const data::SessionSpec& spec, std::int64_t session) {
    data::SqliteRecorder recorder(database, spec.protocol, session);
    static_cast<void>(begin_trial(recorder, spec.protocol, spec.plan.trials[0]));
}

}  // namespace

TEST_CASE("the whole plan is stored before the first trial, as it was made") {
    NewDatabase database;
    const auto spec = session_spec(small_protocol(4));
    const auto opened = data::open_session(database, spec);
    CHECK_FALSE(opened.resumed);
    CHECK(opened.next == 0);
    auto row = database.prepare(
        "SELECT plan_position, phase, planned_object, curvature_per_m, friction, mu_s FROM plan "
        "ORDER BY plan_position");
    for (const auto& planned : spec.plan.trials) {
        REQUIRE(row.step());
        CHECK(row.integer(0) == static_cast<std::int64_t>(planned.position));
        CHECK(row.text(1) == "main");
        CHECK(row.text(2) == spec.protocol.objects[planned.condition.object].name);
        CHECK(row.real(3) == spec.protocol.objects[planned.condition.object].curvature);
        CHECK(row.text(4) == spec.protocol.frictions[planned.condition.friction].name);
        CHECK(row.real(5) == spec.protocol.frictions[planned.condition.friction].mu_s);
    }
    CHECK_FALSE(row.step());
    CHECK(count(database, "picture") == 3);
    CHECK(count(database, "trial") == 0);
    auto hash = database.first("SELECT plan_sha256, seed FROM session");
    CHECK(hash.text(0) == spec.plan.hash);
    CHECK(hash.text(1) == std::to_string(spec.seed));
}

TEST_CASE("a session goes on at the first position without an answer, other attempts stay") {
    NewDatabase database;
    const auto spec = session_spec(small_protocol());
    const std::int64_t session = answer_two_and_die(database, spec);
    {
        const auto again = data::open_session(database, spec);
        CHECK(again.id == session);
        CHECK(again.resumed);
        CHECK(again.next == 2);
        CHECK(again.interrupted == 1);
    }
    CHECK(count(database, "trial WHERE outcome = 'interrupted'") == 1);
    CHECK(count(database, "trial WHERE outcome = 'aborted'") == 1);
    CHECK(count(database,
                "trace_chunk JOIN trial USING (trial_id) WHERE outcome = 'interrupted'") == 1);
    CHECK(count(database, "event WHERE event_kind = 'interrupted'") == 1);
    data::SqliteRecorder recorder(database, spec.protocol, session);
    const auto id = begin_trial(recorder, spec.protocol, spec.plan.trials[2]);
    recorder.end_trial(id, answered(0, false));
    CHECK(count(database, "trial WHERE plan_position = 2 AND attempt = 3") == 1);
    CHECK(data::open_session(database, spec).next == 3);
    CHECK(count(database, "analysis_trial WHERE counts") == 3);
}

TEST_CASE("a session goes on only with what it was begun with, and nothing changes otherwise") {
    NewDatabase database;
    const auto spec = session_spec(small_protocol());
    const auto id = data::open_session(database, spec).id;
    data::SqliteRecorder recorder(database, spec.protocol, id);
    static_cast<void>(begin_trial(recorder, spec.protocol,
                                  spec.plan.trials[0]));  // before it, all may change

    auto changed = small_protocol();
    changed.apparatus.stiffness = 500.0;
    CHECK_THROWS_WITH(data::open_session(database, session_spec(changed)),
                      Has("another version of the protocol (apparatus "
                          "stiffness_n_per_m 1000 there, 500 here); ",
                          "--session"));
    auto seeded = spec;
    seeded.seed = 8;
    seeded.plan = protocols::make_plan(seeded.protocol, seeded.protocol_hash, seeded.key, 8);
    CHECK_THROWS_WITH(data::open_session(database, seeded), Has("another plan", "--seed"));
    auto real = spec;
    real.kind = data::RunKind::real;
    CHECK_THROWS_WITH(data::open_session(database, real), Has("simulated session"));
    auto elsewhere = spec;
    elsewhere.device = "another";
    CHECK_THROWS_AS(data::open_session(database, elsewhere), data::OtherDevice);
    CHECK(count(database, "session") == 1);
    CHECK(count(database, "study") == 1);
    elsewhere.other_device = true;
    CHECK(data::open_session(database, elsewhere).id == id);
}

TEST_CASE(
    "a session goes on with the board that its last trial was felt on, or where that is meant") {
    NewDatabase database;
    auto spec = session_spec(small_protocol());
    const auto board = [&](const std::string& said) -> data::SessionSpec& {
        spec.provenance = {{std::string(protocols::kBoard), said}};
        return spec;
    };
    const auto trial = [&](const data::SessionSpec& by, std::size_t position) {
        const auto opened = data::open_session(database, by);
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[position]),
                           answered(0, false));
    };
    static_cast<void>(data::open_session(database, board("id 3, firmware 1")));
    trial(board("id 7, firmware 1"), 0);  // nothing was felt on 3
    CHECK_THROWS_WITH(data::open_session(database, board("id 3, firmware 1")),
                      Has(", the board with the id 7 so far", ", the board with the id 3"));
    trial(board("id 7, firmware 2"), 1);
    spec.other_device = true;
    static_cast<void>(data::open_session(database, board("id 3, firmware 1")));
    spec.other_device = false;
    trial(board("id 7, firmware 2"), 2);  // nor yet
    spec.other_device = true;
    trial(board("id 3, firmware 1"), 3);
    spec.other_device = false;
    CHECK_THROWS_AS(data::open_session(database, board("id 7, firmware 2")), data::OtherDevice);
    CHECK_NOTHROW(data::open_session(database, board("id 3, firmware 1")));
    CHECK_NOTHROW(data::open_session(database, board("")));  // before it is opened nobody knows
}

TEST_CASE("whatever a session goes on with and without, the last word of each key is what holds") {
    SEEDED(random, std::uint64_t{30});
    NewDatabase database;
    data::SessionSpec spec = session_spec(small_protocol(4));
    const auto objects = protocols::object_hashes(spec.protocol);
    const std::array<std::string, 6> keys{"board",         "device watchdog", "force limit",
                                          "realtime spin", "reply delay",     "stop button"};
    for (std::size_t i = 0; i < 8; ++i) {
        spec.provenance.assign(objects.begin(), objects.end());
        for (const std::string& key : keys) {
            if (random.coin()) {
                spec.provenance.emplace_back(key, random.coin() ? "a" : "b");
            }
        }
        if (i == 1) {  // no trial has begun: planned anew, and what was said before is over
            spec.seed = 8;
            spec.plan = protocols::make_plan(spec.protocol, spec.protocol_hash, spec.key, 8);
        }
        const auto opened = data::open_session(database, spec);
        const data::Provenance holds(spec.provenance.begin(), spec.provenance.end());
        CHECK(data::next_provenance(database, opened.id) == holds);
        const std::int64_t said = count(database, "event");
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        // What was found of a moment is no word that holds, and ends with nothing.
        recorder.event({.kind = protocols::EventKind::provenance,
                        .text = "found",
                        .key = std::string(protocols::kRigCheck),
                        .value = "found"});
        CHECK(data::next_provenance(database, opened.id) == holds);
        CHECK(count(database, "event") == said + 1);
        if (i > 0) {
            recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[i]),
                               answered(0, false));
        }
    }
    CHECK(database.first("SELECT count(*) FROM event WHERE key = 'rig check'").integer(0) == 8);
}

TEST_CASE("a report names each program and limit of force that held for a trial, and no other") {
    NewDatabase database;
    data::SessionSpec spec = session_spec(small_protocol(4));
    const auto runs = [&](const std::string& build, const std::string& limit, std::size_t trials) {
        spec.provenance = {{"build id", build}};
        if (!limit.empty()) {
            spec.provenance.emplace_back("force limit", limit);
        }
        const auto opened = data::open_session(database, spec);
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        for (std::size_t i = opened.next; i < opened.next + trials; ++i) {
            recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[i]),
                               answered(0, false));
        }
    };
    runs("build-0", "0.1 N: of no trial", 0);
    runs("build-1", "0.3 N: nobody proved the rig", 2);
    runs("build-2", "0.2 N: of no trial either", 0);
    runs("build-3", "", 3);
    const std::string page = data::study_page(database, {.kind = "simulated"});
    CHECK_THAT(page, Has(fmt::format("limited to {:g} N (in 2 of the attempts, practice "
                                     "included: 0.3 N: nobody proved the rig). Objects",
                                     spec.protocol.apparatus.force_limit)));
    CHECK_THAT(page, Has("build-1", "build-3"));
    CHECK_THAT(page, !Has("build-0") && !Has("build-2"));
}

TEST_CASE("sessions of a participant are found by number") {
    NewDatabase database;
    CHECK_FALSE(data::find_session(database, "small", "P01").has_value());
    static_cast<void>(data::open_session(database, session_spec(small_protocol(), "P01", 1)));
    static_cast<void>(data::open_session(database, session_spec(small_protocol(), "P01", 2)));
    static_cast<void>(data::open_session(database, session_spec(small_protocol(), "P02", 1)));
    CHECK(data::find_session(database, "small", "P01")->number == 2);
    CHECK(data::find_session(database, "small", "P02")->number == 1);
    CHECK_FALSE(data::find_session(database, "small", "P02", 2).has_value());
    CHECK(count(database, "participant") == 2);
    CHECK(count(database, "study") == 1);
}

TEST_CASE("a session that somebody runs is refused, and its running trial goes on running") {
    const TemporaryFile file("a.sqlite");
    Database rig(file, Access::write);
    const auto spec = session_spec(small_protocol());
    const std::int64_t session = data::open_session(rig, spec).id;
    const data::SessionLock lock(rig, session);
    data::SqliteRecorder recorder(rig, spec.protocol, session);
    const auto trial = begin_trial(recorder, spec.protocol, spec.plan.trials[0]);
    recorder.append(trial, random_ticks(1, 300));
    const std::string before = content_hash(rig);

    Database second(file, Access::write);
    auto elsewhere = spec;
    elsewhere.device = "another device";
    CHECK_THROWS_WITH(data::open_session(second, spec), Has("another palpate"));
    CHECK_THROWS_WITH(data::open_session(second, elsewhere), Has("another palpate"));
    CHECK_THROWS_WITH(data::open_session(rig, spec), Has("another palpate"));

    CHECK(outcomes(rig) == "running, events 0");
    CHECK(content_hash(rig) == before);
    CHECK_NOTHROW(recorder.end_trial(trial, answered(0, true, 300)));
    CHECK(outcomes(rig) == "complete, events 0");
}

TEST_CASE("an opened session has its writer from before it can be seen until it is let go") {
    const TemporaryFile file("a.sqlite");
    Database first(file, Access::write);
    Database second(file, Access::write);
    const auto spec = session_spec(small_protocol());
    for (const bool resumed : {false, true}) {
        CAPTURE(resumed);
        const auto opened = data::open_session(first, spec);
        CHECK(opened.resumed == resumed);
        CHECK_THROWS_WITH(data::open_session(second, spec), Has("another palpate"));
        CHECK_THROWS_WITH(data::SessionLock(second, opened.id), Has("another palpate"));
    }
    CHECK_NOTHROW(data::open_session(second, spec));
    CHECK(outcomes(first) == ", events 0");
}

TEST_CASE("a session that cannot go on is let go") {
    NewDatabase database;
    const auto spec = session_spec(small_protocol());
    const std::int64_t session = data::open_session(database, spec).id;
    begin(database, spec, session);
    auto real = spec;
    real.kind = data::RunKind::real;
    CHECK_THROWS_WITH(data::open_session(database, real), Has("simulated session"));
    CHECK_NOTHROW(data::SessionLock(database, session));
}

// A plan's hash tells its seed, so a plan that was made from another seed is refused by its hash.
// What is refused here is a caller who gives the plan of one seed and the hand and answers of
// another.
TEST_CASE("a session goes on only with its own seed, also when the order is the same") {
    NewDatabase database;
    const auto spec = session_spec(small_protocol());
    begin(database, spec, data::open_session(database, spec).id);
    static_cast<void>(data::open_session(database, spec));
    const std::string before = content_hash(database);
    for (const std::uint64_t seed : {spec.seed + 1, ~std::uint64_t{0}, std::uint64_t{0}}) {
        CAPTURE(seed);
        auto seeded = spec;
        seeded.seed = seed;
        CHECK_THROWS_WITH(data::open_session(database, seeded), Has("seed 7", "--seed"));
    }
    CHECK(content_hash(database) == before);
    CHECK_NOTHROW(data::open_session(database, spec));
}
