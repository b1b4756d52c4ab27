#include "tests/support/console.hpp"

// The experimenter's page, asked as a browser does and as nobody should. Nothing is asserted about
// time.

namespace {

const std::string kPause = R"({"do":"pause"})";
const std::string kPauses = events_of("pause");

}  // namespace

TEST_CASE("only who has the token, from the page itself, gets or does anything",
          "[console][safety]") {
    ShownSession session;
    const Console console(session);
    Browser& browser = *console.browser;
    const auto refused = [](const std::string& answer) {
        CHECK_THAT(answer, StartsWith("HTTP/1.1 4"));
        CHECK_THAT(answer, !Has("\"ok\":true"));
    };
    const std::string foreign = "Origin: http://elsewhere.example\r\n";

    refused(browser.get("/"));
    refused(browser.get("/stream"));
    refused(browser.get("/?token=" + std::string(32, '0')));
    refused(browser.get("/?token="));
    refused(browser.act(kPause, browser.origin()));
    refused(browser.act(kPause, browser.origin() + "Cookie: palpate_" +
                                    std::to_string(browser.port) + "=" + browser.token + "\r\n"));

    const std::string traded = browser.trade();
    CHECK_THAT(traded, StartsWith("HTTP/1.1 303") && Has("; HttpOnly; SameSite=Strict"));
    CHECK_THAT(traded, !Has(browser.token));
    const std::string page = browser.get("/", browser.cookie);
    CHECK_THAT(page, StartsWith("HTTP/1.1 200") && Has("default-src 'none'", "<!DOCTYPE html>"));
    for (const char* file : {"/console.js", "/console.css"}) {
        CHECK_THAT(browser.get(file, browser.cookie), StartsWith("HTTP/1.1 200"));
        CHECK_THAT(page, Has(file));
    }
    refused(browser.get("/../etc/passwd", browser.cookie));
    CHECK_THAT(browser.get("/favicon.ico", browser.cookie), StartsWith("HTTP/1.1 204"));

    const std::string cookie = browser.cookie;
    refused(browser.get("/", cookie + foreign));
    refused(browser.act(kPause, cookie));
    refused(browser.act(kPause, cookie + foreign));
    refused(browser.act(kPause, cookie + browser.origin() + foreign));
    refused(browser.act(kPause, cookie + "Origin: null\r\n"));
    for (const std::string host : {"elsewhere.example", "127.0.0.1", "127.0.0.1:1", ""}) {
        refused(browser.ask("GET / HTTP/1.1\r\nHost: " + host + "\r\n" + cookie));
    }
    refused(browser.ask("GET / HTTP/1.1\r\n" + cookie));
    refused(browser.ask("PUT /do HTTP/1.1\r\nHost: " + browser.host + "\r\n" + cookie +
                        browser.origin() + "Content-Length: 0\r\n"));
    refused(browser.ask("POST /do HTTP/1.1\r\nHost: " + browser.host + "\r\n" + cookie +
                            browser.origin() + "Content-Type: text/plain\r\nContent-Length: 14\r\n",
                        kPause));
    CHECK_THAT(browser.act("[" + kPause + "]"), Has("\"ok\":false"));
    CHECK(session.kept(kPauses) == "0");

    CHECK_THAT(browser.act(kPause), Has("\"ok\":true"));
    CHECK(session.comes_to("pause"));
    CHECK_THAT(browser.act(R"({"do":"go on"})"), Has("\"ok\":true"));  // from the pause
    CHECK(session.keeps(kPauses, "1"));
    CHECK_THAT(browser.act(R"({"do":"stop"})"), Has("\"ok\":true"));
    CHECK(
        session.keeps("SELECT value FROM event WHERE event_kind = 'stop'", "experimenter's page"));
    CHECK(session.program.ended_by(SIGTERM) == 3);
}

TEST_CASE("the page's stream tells nothing of what is felt, and says when the session is gone",
          "[console][safety]") {
    ShownSession session(kFourTrials, {"1"});
    const Console console(session);
    console.browser->trade();
    const auto stream = console.stream();
    CHECK_THAT(stream->hear_until("\"alive\":true"), Has("text/event-stream", "\"act\":true"));
    const auto still = console.stream("?still=1");  // of a page behind another one
    CHECK(eventually([&] {
        stream->forget();
        return stream->hear_until("event: live\ndata: ").find("event: live") != std::string::npos;
    }));
    CHECK(eventually([&] { return session.kept("SELECT count(*) FROM response") >= "1"; }));
    const std::string heard = stream->hear_until(std::string_view("\0\1", 2), 3);
    CHECK_THAT(heard, HasNone("hidden", "convex", "concave", "correct", "friction", "\"hip\"",
                              "strips", "\"f\":"));
    CHECK_THAT(still->hear_until("event: live", 1), Has("event: state") && !Has("event: live"));
    stream->forget();
    session.program.signal(SIGKILL);
    CHECK_THAT(stream->hear_until("\"alive\":false"), Has("\"ended\":\"killed\""));
    CHECK(stream->hear_until("\r\n0\r\n\r\n").ends_with("\r\n0\r\n\r\n"));  // nothing more comes
}

TEST_CASE("of a session that hangs the page says so, and that nobody knows of its force",
          "[console][safety]") {
    ShownSession session(kFourTrials, {"1"});
    const Console console(session);
    console.browser->trade();
    const auto stream = console.stream();
    const auto still = console.stream("?still=1");
    static_cast<void>(stream->hear_until("\"phase\":\"explore\""));
    session.program.signal(SIGSTOP);
    for (const auto& page : {stream.get(), still.get()}) {
        CHECK_THAT(page->hear_until("\"silent_s\":3"),
                   Has("\"force\":{\"on\":null", "the session does not answer"));
        page->forget();
    }
    CHECK_THAT(console.browser->act(R"({"do":"stop"})"),
               Has("\"ok\":false", "the switch of its motors"));
    CHECK_THAT(console.browser->act(R"({"do":"pause"})"), Has("look whether it did"));
    session.program.signal(SIGCONT);
    CHECK_THAT(stream->hear_until("\"silent_s\":null"), Has("\"ended\":null"));
    CHECK(session.keeps(events_of("stop"), "1"));
}

TEST_CASE("of two intervals it is said which one is next, and of a mark which trial it is of",
          "[live]") {
    const ShownSession session("curvature_2afc", {"4"});
    std::string shown;
    REQUIRE(eventually([&] {
        shown = session.state().value("sentence", "");
        return shown.ends_with(", second interval");
    }));
    const std::size_t begin = shown.find("practice");
    const data::Json said = session.ask({{"do", "mark"}});
    CHECK_THAT(said["text"].get<std::string>(),
               StartsWith(shown.substr(begin, shown.rfind(',') - begin) + " is marked once"));
    CHECK(session.keeps(events_of("mark"), "1"));

    CHECK(session.ask({{"do", "pause"}})["ok"] == true);
    REQUIRE(session.comes_to("pause"));
    static_cast<void>(session.ask({{"do", "mark"}}));
    CHECK(session.ask({{"do", "mark"}})["ok"] == false);
    CHECK(session.state()["notes"].back()["text"] == "a mark found no answer that counts");
}

TEST_CASE("a preview shows what a protocol shows, and each problem at its line once it is saved",
          "[console]") {
    const TemporaryFile file("mine.toml");
    const std::string good = slurp(PALPATE_SOURCE_DIR "/tests/golden/four_trials.toml");
    write(file, good);
    Process preview({palpate_program(), "preview", file});
    const Browser browser = browser_of(preview);
    const auto stream = browser.stream();
    CHECK_THAT(stream->hear_until("\"objects\":\"objects.svg\"}"),
               Has("\"right\":true", "\"welcome.png\"") && !Has("objects drawn in"));
    CHECK_THAT(browser.get("/choose.png", browser.cookie), Has("image/png"));
    CHECK_THAT(browser.get("/objects.svg", browser.cookie), Has("<svg"));
    CHECK_THAT(browser.get("/said.txt", browser.cookie), StartsWith("HTTP/1.1 404"));
    stream->forget();
    write(file, replaced(good, "rate_hz = 1000", "rate_hz = 1"));
    CHECK_THAT(stream->hear_until("\"objects\":null}"), Has("mine.toml:11:11: rate_hz is 1"));
    CHECK_THAT(browser.get("/choose.png", browser.cookie), StartsWith("HTTP/1.1 404"));
    CHECK(preview.ended_by(SIGTERM) == 0);
}

TEST_CASE("a preview shows of a rule's stimuli what is known before anybody answers", "[console]") {
    const TemporaryFile file("mine.toml");
    const std::string stairs =
        slurp(PALPATE_SOURCE_DIR "/protocols/library/friction_threshold.toml");
    write(file, stairs);
    Process preview({palpate_program(), "preview", file, "--device", "sim"});
    const Browser browser = browser_of(preview);
    const auto stream = browser.stream();
    /// What stands behind "mu" in trials of a phase.
    const auto levels = [&](const std::string& phase) {
        const std::string heard = stream->hear_until("\"objects\":\"objects.svg\"}");
        Words all;
        for (const std::string& line : split(all_replaced(heard, "\\n", "\n"), '\n')) {
            if (line.starts_with("trial ")) {
                REQUIRE_THAT(line, Has(", mu "));
                if (line.find("  " + phase) != std::string::npos) {
                    all.push_back(behind(line, ", mu ", "  ("));
                }
            }
        }
        return all;
    };
    CHECK(levels("practice") == Words(4, "0.9"));
    Words main = levels("main");
    REQUIRE(main.size() == 80);
    CHECK(main.back() == "0.305 to 1.2");  // 40 answers of a kind lead to either end
    std::erase_if(main, [](const std::string& mu) { return mu.find(" to ") != std::string::npos; });
    std::ranges::sort(main);
    CHECK(main == Words{"0.6", "0.9"});  // where its staircases begin
    CHECK_THAT(stream->hear_until("event: felt"),
               Has(R"(["more, standard","more, mu 0.305","more, mu 0.7525","more, mu 1.2"])"));

    stream->forget();
    const std::size_t kind = stairs.find("kind = \"staircase\"");
    write(file, stairs.substr(0, kind) +
                    "kind = \"constant\"\n[procedure.constant]\nstimuli = [0.4, 0.9]\n"
                    "repetitions = 3\n" +
                    stairs.substr(stairs.find("[[run]]")));
    main = levels("main");
    std::ranges::sort(main);
    CHECK(main == Words{"0.4", "0.4", "0.4", "0.9", "0.9", "0.9"});
    CHECK(preview.ended_by(SIGTERM) == 0);
}
