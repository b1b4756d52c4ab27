#include "engine/base/text.hpp"
#include "data/analysis/summary.hpp"
#include "data/store/people.hpp"
#include "tests/support/program.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::data;

namespace {

/// Answers all that is left.
void run_on(Database& database, const data::SessionSpec& spec) {
    auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    for (const std::size_t at : opened.progress.pending().order()) {
        recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[at]),
                           answered(0, false));
    }
    recorder.finish_session();
}

}  // namespace

TEST_CASE("an answer that does not count is kept with its reason, left out and counted apart",
          "[store][invalid][law]") {
    SmallSession session;
    Database& database = session.database;
    auto bad = answered(1, true);
    bad.invalid = "path 12.0 mm, below 160 mm";
    const auto id = session.record(0, bad);
    CHECK_THAT(data::summary_text(database), Has("1 answered trial is invalid"));
    session.record(1, answered(1, true));
    CHECK(lines(database,
                "SELECT trial_id, invalid_reason FROM analysis_trial WHERE invalid_reason IS NOT "
                "NULL") == fmt::format("{} path 12.0 mm, below 160 mm \n", id));
    CHECK(lines(database, "SELECT plan_position FROM analysis_trial WHERE counts") == "1 \n");
    CHECK(lines(database, "SELECT sum(n) FROM confusion") == "1 \n");
    CHECK(lines(database, "SELECT count(*) FROM response") == "2 \n");
    // The recorder takes no reason for what was not answered.
    protocols::TrialResult aborted;
    aborted.outcome = protocols::Outcome::aborted;
    aborted.invalid = "x";
    CHECK_THROWS_AS(session.record(2, aborted), std::logic_error);
}

TEST_CASE("an answer marked afterwards is left out, kept, and run again unless all is finished",
          "[store][invalid][law]") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    const auto spec = session_spec(small_protocol());
    {
        const auto opened = data::open_session(database, spec);
        data::SqliteRecorder recorder(database, spec.protocol, opened.id);
        for (std::size_t i = 0; i < 3; ++i) {
            recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[i]),
                               answered(0, false));
        }
        protocols::TrialResult aborted;
        aborted.outcome = protocols::Outcome::aborted;
        recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[3]), aborted);
        CHECK_THROWS_WITH(data::mark_invalid(database, 2, {"x"}), Has("runs now"));
    }
    CHECK_THROWS_WITH(data::mark_invalid(database, 99, {"x"}), Has("no trial 99"));
    CHECK_THROWS_WITH(data::mark_invalid(database, 4, {"x"}), Has("aborted"));
    CHECK_FALSE(data::mark_invalid(database, 2, {"she sneezed"}).finished);
    CHECK_THROWS_WITH(data::mark_invalid(database, 2, {"again"}), Has("she sneezed"));
    CHECK(lines(database, "SELECT trial_id FROM analysis_trial WHERE counts ORDER BY 1") ==
          "1 \n3 \n");
    CHECK(lines(database, "SELECT trial_id, text FROM event WHERE event_kind = 'mark'") ==
          "2 she sneezed \n");
    {
        const auto opened = data::open_session(database, spec);
        CHECK(opened.progress.pending().has(1));
        CHECK_FALSE(opened.progress.pending().has(0));
        CHECK_FALSE(opened.progress.pending().has(2));
        // What was aborted stays where it was; the marked one is somewhere after where it might
        // have been next.
        std::vector<std::size_t> others = opened.progress.pending().order();
        std::erase(others, 1U);
        CHECK(others == std::vector<std::size_t>{3, 4, 5});
    }
    run_on(database, spec);
    CHECK(data::mark_invalid(database, 1, {"late"}).finished);
    CHECK(data::open_session(database, spec).finished);
}

TEST_CASE("what is noted of a participant stays until it is noted otherwise", "[store][people]") {
    const TemporaryFolder folder;
    Database database(folder.file("a.sqlite"), Access::write);
    CHECK_FALSE(data::find_participant(database, "P1").has_value());
    data::note_participant(database, "P1", {.handedness = 80, .consent = true});
    data::note_participant(database, "P1", {.details = {{"age", "31"}, {"gender", "f"}}});
    data::note_participant(database, "P1", {.handedness = -100, .details = {{"age", "32"}}});
    const auto person = data::find_participant(database, "P1");
    REQUIRE(person.has_value());
    CHECK(person->notes.handedness == -100);
    CHECK(person->notes.consent == true);
    CHECK_FALSE(person->consent_utc.empty());
    CHECK(person->notes.details ==
          std::vector<std::pair<std::string, std::string>>{{"age", "32"}, {"gender", "f"}});
    CHECK(person->sessions == 0);
    data::note_participant(database, "P1", {.consent = false});
    CHECK(data::find_participant(database, "P1")->notes.consent == false);
    CHECK_THROWS_AS(data::note_participant(database, "P2", {.handedness = 101}), data::StoreError);
    CHECK_FALSE(data::find_participant(database, "P2").has_value());  // all or nothing
}

TEST_CASE("participant, note and mark work from the command line and refuse with a sentence",
          "[people][cli]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const Finished unknown = palpate_command({"participant", file, "P1"});
    CHECK(unknown.code != 0);
    CHECK(palpate_command({"note", file, "text", "--participant", "P1"}).code != 0);
    CHECK(palpate_command({"mark", file, "1", "--invalid", "x"}).code != 0);
    ran({"participant", file, "Jane Doe", "--consent", "yes"}, 2);
    ran({"participant", file, "P1", "--set", "Age=3"}, 2);
    ran({"participant", file, "P1", "--handedness", "101"}, 2);
    CHECK(::access(file.c_str(), F_OK) != 0);  // nothing was made of all that

    const Finished noted = ran({"participant", file, "P1", "--new", "--handedness", "-40",
                                "--consent", "yes", "--set", "age=31", "--set", "x="});
    CHECK_THAT(noted.out, Has("handedness   -40", "consent      yes, noted 2", "age          31"));
    CHECK(palpate_command({"participant", file, "P1"}).out == noted.out);
    ran({"participant", file, "P2"}, 2);
    CHECK_THAT(ran({"participant", file, "P2", "--set", "age=32"}, 2).error,
               Has("nobody is called P2: --new registers them"));
    CHECK_THAT(ran({"participant", file, "P1", "--new", "--consent", "no"}, 2).error,
               Has("P1 is there already"));
    CHECK(palpate_command({"participant", file, "P1"}).out == noted.out);
    CHECK_THAT(palpate_command({"note", file, "text", "--participant", "P1"}).error,
               Has("P1 has no session yet"));
    {
        Database database(file, Access::write);
        for (const std::size_t number : {1U, 2U}) {
            const auto spec = session_spec(small_protocol(), "P1", number);
            const auto opened = data::open_session(database, spec);
            data::SqliteRecorder recorder(database, spec.protocol, opened.id);
            recorder.end_trial(begin_trial(recorder, spec.protocol, spec.plan.trials[0]),
                               answered(0, false));
        }
        auto other = small_protocol();
        other.id = "other";
        static_cast<void>(data::open_session(database, session_spec(other, "P1", 1)));
    }
    CHECK_THAT(palpate_command({"note", file, "text", "--participant", "P1"}).error,
               Has("other and in small: give --study"));
    CHECK(palpate_command({"note", file, " ", "--participant", "P1", "--study", "small"}).code ==
          2);
    CHECK_THAT(
        palpate_command({"note", file, "tired", "--participant", "P1", "--study", "small"}).out,
        Has("session 2 of P1, study small"));
    ran({"note", file, "early", "--participant", "P1", "--study", "small", "--session", "1"});
    CHECK_THAT(palpate_command({"mark", file, "1", "--invalid", "bell rang"}).out,
               Has("run again when its session is resumed"));
    ran({"mark", file, "1", "--invalid", "bell rang"}, 2);
    Database database(file, Access::read);
    CHECK(lines(database,
                "SELECT session_number, event.event_kind, text FROM event JOIN session USING "
                "(session_id) WHERE event.event_kind <> 'participant' ORDER BY event.event_id") ==
          "2 note tired \n1 note early \n1 mark bell rang \n");
    CHECK(lines(database, "SELECT count(*) FROM participant") == "1 \n");
}

TEST_CASE("UTF-8 is distinguished from what is none, byte by byte as RFC 3629 has it", "[people]") {
    // Every sequence of one, two and three bytes against the ranges of the RFC's table 3-7 in
    // Unicode.
    const auto by_table = [](unsigned a, unsigned b, unsigned c) -> std::size_t {
        const auto tail = [](unsigned x) {
            return x >= 0x80 && x <= 0xBF;
        };
        if (a <= 0x7F) {
            return 1;
        }
        if (a >= 0xC2 && a <= 0xDF && tail(b)) {
            return 2;
        }
        const bool second = a == 0xE0 ? b >= 0xA0 && b <= 0xBF
                          : a == 0xED ? b >= 0x80 && b <= 0x9F
                                      : tail(b);
        return a >= 0xE0 && a <= 0xEF && second && tail(c) ? 3 : 0;
    };
    std::size_t wrong = 0;
    for (unsigned a = 0; a < 0xF0; ++a) {
        for (unsigned b = 0; b < 256; ++b) {
            for (const unsigned c : {0x00U, 0x41U, 0x7FU, 0x80U, 0xBFU, 0xC0U, 0xFFU}) {
                const char bytes[] = {static_cast<char>(a), static_cast<char>(b),
                                      static_cast<char>(c)};
                wrong += utf8_length({bytes, 3}) == by_table(a, b, c) ? 0U : 1U;
            }
        }
    }
    CHECK(wrong == 0);
    CHECK(utf8_length("\xF0\x9F\x98\x80") == 4);
    for (const char* bad : {"\xF0\x8F\xBF\xBF", "\xF4\x90\x80\x80", "\xF5\x80\x80\x80",
                            "\xF0\x9F\x98", "\xE2\x82", "\xC3", "a\x80"}) {
        CHECK_FALSE(is_utf8(bad));
    }
    CHECK(is_utf8("çukur, 凹, \xF0\x9F\x98\x80"));
}

TEST_CASE("words that are not UTF-8 are refused before they are kept", "[people]") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    ran({"demo", "--headless", "--db", file});
    Database database(file, Access::read);
    const auto noted = [&] {
        return lines(database, "SELECT count(*) FROM event") +
               lines(database, "SELECT count(*) FROM participant_detail");
    };
    const std::string before = noted();
    const std::string code = lines(database, "SELECT participant_code FROM participant");
    const std::string who = code.substr(0, code.find(' '));
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"note", file, "caf\xE9", "--participant", who},
          {"mark", file, "1", "--invalid", "\xFF"},
          {"participant", file, who, "--set", "name=Ren\xE9"}}) {
        CHECK_THAT(ran(words, 2).error, Has("UTF-8"));
    }
    CHECK(noted() == before);
}
