#include <list>

#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <sys/socket.h>

#include "data/store/database.hpp"
#include "data/store/session_lock.hpp"
#include "ui/rig/control_line.hpp"
#include "ui/rig/stop_lines.hpp"
#include "tests/support/console.hpp"
#include "tests/support/program.hpp"
#include "tests/support/random.hpp"
#include "tests/support/window_session.hpp"

// What others see of a running session and may ask of it: the program itself, its control socket
// and its shared memory. Nothing is asserted about time.

TEST_CASE("what is asked of a running session is done by its own events, and the file says so",
          "[live]") {
    ShownSession session;
    CHECK(session.ask({{"do", "go on"}})["ok"] == false);

    CHECK(session.ask({{"do", "pause"}})["ok"] == true);
    REQUIRE(session.comes_to("pause"));
    CHECK(session.ask({{"do", "pause"}})["ok"] == false);
    CHECK(session.kept(events_of("pause")) == "1");
    CHECK(session.kept(events_of("go on")) == "0");

    CHECK(session.ask({{"do", "note"}, {"text", " \n"}})["ok"] == false);
    CHECK(session.ask({{"do", "note"}, {"text", "they scratch their nose \u2014 twice"}})["ok"] ==
          true);
    CHECK(session.keeps("SELECT text FROM event WHERE event_kind = 'note'",
                        "they scratch their nose \u2014 twice"));
    CHECK(session.state()["notes"][0]["text"] == "they scratch their nose \u2014 twice");

    // So is what is noted while something is felt, and a mark when that is over.
    CHECK(session.ask({{"do", "go on"}})["ok"] == true);
    REQUIRE(session.comes_to("explore"));
    CHECK(session.ask({{"do", "note"}, {"text", "the second"}})["ok"] == true);
    CHECK(session.ask({{"do", "mark"}, {"reason", "a sneeze"}})["ok"] == true);
    CHECK(session.keeps("SELECT text FROM event WHERE event_kind = 'note' AND trial_id IS NOT NULL",
                        "the second"));
    CHECK(session.keeps("SELECT count(*) FROM trial WHERE invalid_reason LIKE '%: a sneeze'", "1"));
    CHECK(eventually([&] { return !session.state()["not_counting"].empty(); }));
    CHECK_THAT(session.state()["not_counting"][0]["why"].get<std::string>(), Has("a sneeze"));

    CHECK(session.ask({{"do", "pause"}})["ok"] == true);  // that ends by no "go on"
    REQUIRE(session.comes_to("pause"));
    const data::Json asked = session.ask({{"do", "end"}});
    CHECK(asked["ok"] == false);
    CHECK(session.ask({{"do", "end"}, {"word", "no"}})["ok"] == false);
    CHECK(session.ask({{"do", "end"}, {"word", asked["word"]}})["ok"] == false);  // another by now
    CHECK(session.program.running());
    const data::Json again = session.ask({{"do", "end"}});
    CHECK(session.ask({{"do", "end"}, {"word", again["word"]}})["ok"] == true);
    CHECK(session.program.wait().code == 3);
    CHECK(session.state()["ended"] == "ended early");
    CHECK_FALSE(session.shown.alive());
    CHECK(session.kept(events_of("pause")) == "2");
    CHECK(session.kept(events_of("go on")) == "1");
    ran({"verify", session.file});
}

TEST_CASE("a mark is of the trial that is meant, and a note of the one that the file has",
          "[live]") {
    ShownSession session(kFourTrials, {"1"});
    CHECK(session.state()["markable"].is_null());
    REQUIRE(session.comes_to("explore"));
    const data::Json meant = session.state()["markable"];
    CHECK(meant["name"] == "trial 1 of 4");
    CHECK(session.ask({{"do", "note"}, {"text", "felt"}})["ok"] == true);
    ran({"note", session.file, "from a shell", "--participant", "P1"});
    for (const data::Json& note : session.state()["notes"]) {
        CHECK((note["trial"].is_null() ? "" : "1") ==
              session.kept("SELECT coalesce(trial_id, '') FROM event WHERE text = '" +
                           note["text"].get<std::string>() + "'"));
    }
    REQUIRE(eventually([&] { return session.state()["markable"] != meant; }));
    const data::Json late = session.ask({{"do", "mark"}, {"trial", meant["trial_id"]}});
    CHECK(late["ok"] == false);
    CHECK_THAT(late["text"].get<std::string>(), Has("palpate mark FILE 1 --invalid"));
    const data::Json now = session.state()["markable"]["trial_id"];
    for (const data::Json& no_id : {data::Json("1"), data::Json(0), data::Json(-1), data::Json(1.5),
                                    data::Json(true), data::Json::array({1})}) {
        CHECK(session.ask({{"do", "mark"}, {"trial", no_id}, {"reason", "late"}})["ok"] == false);
    }
    CHECK(session.ask({{"do", "mark"}, {"trial", now}, {"reason", "late"}})["ok"] == true);
    CHECK(session.program.wait().code == 0);
    CHECK(session.kept("SELECT group_concat(trial_id) FROM trial WHERE invalid_reason LIKE "
                       "'marked%'") == now.dump());
}

TEST_CASE("what was noted while something is felt is kept by a file that is killed at once",
          "[live]") {
    ShownSession session(kFourTrials, {"0.5"});
    REQUIRE(session.comes_to("explore"));
    CHECK(session.ask({{"do", "note"}, {"text", "the chair creaks"}})["ok"] == true);
    const data::Json asked = session.ask({{"do", "reveal"}});
    CHECK(session.ask({{"do", "reveal"}, {"word", asked["word"]}})["ok"] == true);
    session.program.signal(SIGKILL);
    CHECK(session.program.wait().code == 128 + SIGKILL);
    CHECK(session.kept("SELECT count(*) FROM response") == "0");
    CHECK(session.kept("SELECT text FROM event WHERE event_kind = 'note' AND trial_id = 1") ==
          "the chair creaks");
    CHECK(session.kept(events_of("reveal")) == "1");
}

TEST_CASE("two who ask at once are both answered, and done once", "[live]") {
    ShownSession session;
    const auto both = [&](const std::string& what) {
        const Descriptor one = ui::connect_to(session.shown.name);
        const Descriptor other = ui::connect_to(session.shown.name);
        ui::send_line(one.get(), what);
        ui::send_line(other.get(), what);
        std::string said;
        for (const int from : {one.get(), other.get()}) {
            REQUIRE(ui::readable(from, 5000));
            said += ui::receive(from).line;
        }
        return said;
    };
    for (const std::string times : {"1", "2", "3"}) {
        static_cast<void>(both(R"({"do":"pause"})"));
        REQUIRE(session.comes_to("pause"));
        CHECK(both(R"({"do":"go on"})").find("it goes on") != std::string::npos);
        CHECK(session.keeps(events_of("go on"), times));
        CHECK(session.kept(events_of("pause")) == times);
    }
    CHECK(session.program.ended_by(SIGTERM) == 3);
}

TEST_CASE("nothing of what is felt or answered leaves a session before it was revealed",
          "[live][safety]") {
    ShownSession session(kFourTrials, {"1"});
    std::set<std::string> said;
    std::uint64_t seen = 0;
    std::size_t shown = 0;  // ticks with more than time, lateness and whether there may be force
    const auto look = [&] {
        if (const auto state = session.shown.reader->state()) {
            said.insert(state->json);
        }
        const auto [ticks, count] = session.shown.reader->ticks_after(std::exchange(seen, 0));
        seen = count;
        for (const ui::LiveTick& tick : ticks) {
            const ui::LiveTick blind{
                .tick = {.time_ns = tick.tick.time_ns, .lateness_us = tick.tick.lateness_us},
                .force_on = tick.force_on};
            shown += std::memcmp(&tick, &blind, sizeof tick) != 0 ? 1U : 0U;
        }
        return session.kept("SELECT count(*) FROM response") >= "2";
    };
    REQUIRE(eventually(look));
    CHECK(seen > 0);
    CHECK(shown == 0);
    for (const std::string& state : said) {
        CHECK_THAT(state, HasNone("hidden", "convex", "concave", "correct", "friction"));
    }

    CHECK(session.ask({{"do", "pause"}})["ok"] == true);
    REQUIRE(session.comes_to("pause"));
    const data::Json asked = session.ask({{"do", "reveal"}});
    CHECK(asked["ok"] == false);
    CHECK(session.kept(events_of("reveal")) == "0");
    CHECK_FALSE(session.state().contains("hidden"));
    CHECK(session.ask({{"do", "reveal"}, {"word", asked["word"]}})["ok"] == true);
    CHECK(session.keeps("SELECT value FROM event WHERE event_kind = 'reveal'", "Ada"));
    REQUIRE(eventually([&] { return session.state().contains("hidden"); }));
    CHECK(session.state()["reveal"] == "shown");
    CHECK(session.state()["hidden"]["answers"].size() >= 2);
    CHECK(session.state()["hidden"]["outline"].size() > 10);
    CHECK(session.ask({{"do", "go on"}})["ok"] == true);
    CHECK(eventually([&] {
        const auto ticks = session.shown.reader->ticks_after(0).first;
        return !ticks.empty() && ticks.back().tick.hip != engine::Vec3{};
    }));
    CHECK(session.program.wait().code == 0);
    CHECK(session.kept(events_of("reveal")) == "1");
    ran({"verify", session.file});
}

TEST_CASE("a protocol that says reveal = \"never\" shows nothing to anybody", "[live]") {
    const TemporaryFile file("never.toml");
    write(file,
          replaced(four_trials(), "participants = 1", "participants = 1\nreveal = \"never\""));
    ShownSession session(file);
    CHECK(session.state()["reveal"] == "never");
    const data::Json asked = session.ask({{"do", "reveal"}});
    CHECK(asked["ok"] == false);
    CHECK_FALSE(asked.contains("word"));
    CHECK(session.program.ended_by(SIGTERM) == 3);
    CHECK(session.kept(events_of("reveal")) == "0");
}

TEST_CASE("nobody obeys what is no order, and nobody writes into what a session shows",
          "[live][safety]") {
    ShownSession session;
    Random random(32);
    const Words pieces{"{",        "}",        "\"do\"", ":",        "\"stop",       "\"end\"",
                       "\"mark\"", "[",        "]",      "null",     "1e999",        "\\u0000",
                       "\xff",     "\"word\"", ",",      "\"pause ", " \"go on\"\"", "\"note\"",
                       "\"text\""};
    for (int i = times("PALPATE_RANDOM_LINES", 2000); i > 0; --i) {
        std::string line;
        for (int n = random.below(12); n > 0; --n) {
            line += pieces[random.index(pieces.size())];
        }
        const data::Json asked = data::Json::parse(line, nullptr, false);
        if (asked.is_object() && asked.contains("do")) {
            continue;  // that one may be an order
        }
        CAPTURE(line);
        const data::Json answer =
            data::Json::parse(ui::ask_session(session.shown.name, line).line, nullptr, false);
        REQUIRE(answer.is_object());
        REQUIRE(answer["ok"] == false);
    }
    CHECK(session.ask({{"do", "stop"}, {"people", true}})["ok"] == false);  // of palpate stop alone
    // What has no end, what is too long, who says nothing, and who hangs up at once.
    std::vector<Descriptor> silent;
    for (int i = 0; i < 40; ++i) {
        silent.push_back(ui::connect_to(session.shown.name));
        const Descriptor gone = ui::connect_to(session.shown.name);
    }
    const Descriptor endless = ui::connect_to(session.shown.name);
    for (int i = 0; i < 10; ++i) {
        ui::send_line(endless.get(), std::string(4000, '{'));
    }
    const ui::Received state = ui::ask_session(session.shown.name, R"({"do":"state"})");
    REQUIRE(state.file.get() >= 0);
    CHECK(mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_SHARED, state.file.get(), 0) ==
          MAP_FAILED);
    CHECK(ftruncate(state.file.get(), 0) != 0);
    CHECK(session.kept("SELECT count(*) FROM event WHERE event_kind IN ('note', 'mark', 'pause', "
                       "'stop', 'reveal')") == "0");
    ran({"stop", session.file});
    CHECK(session.program.ended_by(SIGTERM) == 3);
    ran({"verify", session.file});
}

TEST_CASE("however many called a session that hangs, palpate stop is obeyed when it goes on",
          "[live][safety]") {
    ShownSession session;
    const auto others_call = [&] {
        for (int i = 0; i < 40; ++i) {
            const Descriptor gone = ui::connect_to(session.shown.name);
        }
    };
    session.program.signal(SIGSTOP);
    others_call();
    CHECK_THAT(palpate_command({"stop", session.file}).error, Has("did not answer in 2 s"));
    others_call();
    session.program.signal(SIGCONT);
    CHECK(session.keeps(events_of("stop"), "1"));
}

TEST_CASE("who asked a session that hung, and hung up, is not obeyed when it goes on", "[live]") {
    ShownSession session;
    session.program.signal(SIGSTOP);
    const Descriptor waits = ui::connect_to(session.shown.name);
    {
        const Descriptor gone = ui::connect_to(session.shown.name);
        ui::send_line(gone.get(), R"({"do":"note","text":"gave up"})");
        ui::send_line(waits.get(), R"({"do":"note","text":"waits"})");
        shutdown(waits.get(), SHUT_WR);  // has said it all, and hears the answer
    }
    session.program.signal(SIGCONT);
    REQUIRE(session.keeps(events_of("note"), "1"));
    REQUIRE(ui::readable(waits.get(), 2000));
    CHECK(data::Json::parse(ui::receive(waits.get()).line)["ok"] == true);
    const auto asked = session.ask({{"do", "note"}, {"text", std::string("one\0two", 7)}});
    CHECK(asked["ok"] == false);
    CHECK(session.kept("SELECT text FROM event WHERE event_kind = 'note'") == "waits");
}

TEST_CASE("a session that palpate stop cannot reach says so", "[live][safety]") {
    const TemporaryFile file("d.sqlite");
    const auto said = [&](const char* who) {
        return palpate_command(run_words(kFourTrials, who, file, {"--headless"})).error;
    };
    CHECK_THAT(said("P1"), !Has("do not reach this one"));
    std::list<ui::ControlSocket> others;
    for (int i = 0; i < 8; ++i) {
        others.emplace_back(file);
    }
    CHECK_THAT(said("P2"), Has("palpate stop", "do not reach this one"));
    others.pop_back();
    CHECK_THAT(said("P3"), !Has("do not reach this one"));
}

TEST_CASE("palpate stop says that a force is off only of whose motors are proved to be off",
          "[live][safety]") {
    const TemporaryFile file("d.sqlite");
    static_cast<void>(data::Database(file, data::Access::write));
    const auto runs = [&](const char* label, bool doubts) {
        return std::make_unique<ui::StopLines>(
            file, label, nullptr,
            ui::StopLines::Acts{
                .stop = [](const char*) {}, .doubts = [=] { return doubts; }, .types = false});
    };
    const auto stop = [&] {
        return palpate_command({"stop", file});
    };
    const auto lost = runs("the lost one\n", true);
    const Finished alone = stop();
    CHECK(alone.code == 1);
    CHECK(alone.out.empty());
    CHECK_THAT(alone.error, Has("of 1 session: nothing proves", "the lost one"));
    const auto proved = runs("the proved one\n", false);
    const Finished both = stop();
    CHECK(both.code == 1);
    CHECK(both.out == "No force any more in 1 session:\nthe proved one\n");
    CHECK_THAT(both.error, Has("of 1 session: nothing proves", "the lost one"));
    CHECK_THAT(both.error, !Has("the proved one"));
}

TEST_CASE("another user is heard only with the file open for writing, and then only a stop",
          "[live][safety]") {
    ShownSession session;
    const std::string name = session.shown.name;
    const auto answer_to = [&](const std::string& line, int right) {
        const Descriptor to = ui::connect_to(name);
        ui::send_line(to.get(), line, right);
        static_cast<void>(ui::readable(to.get(), 5000));
        return ui::receive(to.get()).line;
    };
    const Descriptor reads(open((session.file + "-wal").c_str(), O_RDONLY | O_CLOEXEC));
    const Descriptor writes(open((session.file + "-wal").c_str(), O_RDWR | O_CLOEXEC));
    const TemporaryFolder folder;
    const Descriptor other(
        open(folder.file("another").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, S_IRUSR | S_IWUSR));
    const std::string kStop = R"({"do":"stop"})";
    CHECK(holds_for_a_stranger([&] {
        return answer_to(R"({"do":"state"})", -1).empty() && answer_to(kStop, -1).empty() &&
               answer_to(kStop, reads.get()).empty() && answer_to(kStop, other.get()).empty();
    }));
    CHECK(session.kept(events_of("stop")) == "0");
    CHECK(holds_for_a_stranger([&] {
        return answer_to(R"({"do":"pause"})", writes.get()).find("only stop") !=
                   std::string::npos &&
               answer_to(R"({"do":"state"})", writes.get()).find("only stop") !=
                   std::string::npos &&
               answer_to(kStop, writes.get()).find("\"ok\":true") != std::string::npos;
    }));
    CHECK((geteuid() != 0 || session.keeps(events_of("stop"), "1")));
    CHECK(session.kept(events_of("pause")) == "0");
    CHECK(session.program.ended_by(SIGTERM) == 3);
}

TEST_CASE("a mark of a trial that is over is answered by what came of it", "[window][live][law]") {
    const TemporaryFile file("d.sqlite");
    WindowSession session({"run", kFourTrials, "--participant", "P1", "--db", file, "--device",
                           "mouse", "--kind", "pilot"});
    session.go_through({"welcome", "ready", "explore"});
    session.press_at("question", "2");
    session.wait_for_screen("ready");
    const std::string name = ui::running_sessions(file).at(0).name;
    for (const char* says : {"trial 1 of 4 #1 is marked: it does not count and runs again later",
                             "nothing to mark: no answer of this run"}) {
        const data::Json said = data::Json::parse(
            ui::ask_session(name, R"({"do":"mark","reason":"the bell rang"})").line);
        CHECK_THAT(said.value("text", ""), StartsWith(says));
    }
    CHECK(session.program().ended_by(SIGTERM) == 3);
    CHECK(session.ask("SELECT count(*) FROM trial WHERE invalid_reason LIKE '%the bell rang'") ==
          "1");
}
