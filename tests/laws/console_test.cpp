#include <csignal>

#include "tests/support/catch.hpp"
#include "tests/support/console.hpp"
#include "tests/support/slurp.hpp"

// The experimenter's page, asked as a browser does and as nobody should. Nothing is asserted about
// time.

using namespace palpate;
using Catch::Matchers::StartsWith;
using tests::Browser;
using tests::Console;
using tests::eventually;
using tests::ShownSession;

namespace {

const std::string kPause = R"({"do":"pause"})";
constexpr const char* kPauses = "SELECT count(*) FROM event WHERE event_kind = 'pause'";

}  // namespace

TEST_CASE("only who has the token, from the page itself, gets or does anything",
          "[console][safety][law]") {
    ShownSession session;
    const Console console(session);
    Browser& browser = *console.browser;
    const auto refused = [](const std::string& answer) {
        CHECK_THAT(answer, StartsWith("HTTP/1.1 4"));
        CHECK(answer.find("\"ok\":true") == std::string::npos);
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
    CHECK(traded.find(browser.token) == std::string::npos);
    const std::string page = browser.get("/", browser.cookie);
    CHECK_THAT(page, StartsWith("HTTP/1.1 200") && Has("default-src 'none'", "<!DOCTYPE html>"));
    for (const char* file : {"/console.js", "/console.css", "/uplot.js", "/uplot.css"}) {
        CHECK_THAT(browser.get(file, browser.cookie), StartsWith("HTTP/1.1 200"));
        CHECK(page.find(file) != std::string::npos);
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
    CHECK_THAT(browser.act("[" + kPause + "]", cookie + browser.origin()), Has("\"ok\":false"));
    CHECK(session.kept(kPauses) == "0");

    CHECK_THAT(browser.act(kPause, cookie + browser.origin()), Has("\"ok\":true"));
    CHECK(session.comes_to("pause"));
    CHECK_THAT(browser.act(R"({"do":"go on"})", cookie + browser.origin()),
               Has("\"ok\":true"));  // from the pause
    CHECK(session.keeps(kPauses, "1"));
    CHECK_THAT(browser.act(R"({"do":"stop"})", cookie + browser.origin()), Has("\"ok\":true"));
    CHECK(
        session.keeps("SELECT value FROM event WHERE event_kind = 'stop'", "experimenter's page"));
    session.program.signal(SIGTERM);
    CHECK(session.program.wait().code == 3);
}

TEST_CASE("the page's stream tells nothing of what is felt, and says when the session is gone",
          "[console][safety][law]") {
    ShownSession session(tests::kFourTrials, {"1"});
    const Console console(session);
    console.browser->trade();
    tests::HttpLine stream(console.browser->port);
    stream.say("GET /stream HTTP/1.1\r\nHost: " + console.browser->host + "\r\n" +
               console.browser->cookie + "\r\n");
    CHECK_THAT(stream.hear_until("\"alive\":true"), Has("text/event-stream", "\"act\":true"));
    CHECK(eventually([&] {
        stream.forget();
        return stream.hear_until("event: live\ndata: ").find("event: live") != std::string::npos;
    }));
    CHECK(eventually([&] { return session.kept("SELECT count(*) FROM response") >= "1"; }));
    const std::string heard = stream.hear_until(std::string_view("\0\1", 2), 3);
    for (const char* word :
         {"hidden", "convex", "concave", "correct", "friction", "\"hip\"", "strips", "\"f\":"}) {
        CAPTURE(word);
        CHECK(heard.find(word) == std::string::npos);
    }
    stream.forget();
    session.program.signal(SIGKILL);
    CHECK_THAT(stream.hear_until("\"alive\":false"), Has("\"ended\":\"killed\""));
    CHECK(stream.hear_until("\r\n0\r\n\r\n").ends_with("\r\n0\r\n\r\n"));  // nothing more comes
}

TEST_CASE("a preview shows what a protocol shows, and each problem at its line once it is saved",
          "[console][law]") {
    const tests::TemporaryFolder folder;
    const std::string file = folder.file("mine.toml");
    const std::string good = tests::slurp(PALPATE_SOURCE_DIR "/tests/golden/four_trials.toml");
    tests::write(file, good);
    tests::Process preview({tests::palpate_program(), "preview", file});
    REQUIRE(eventually([&] { return preview.out().find("\nCtrl+C") != std::string::npos; }));
    Browser browser(preview.out());
    browser.trade();
    tests::HttpLine stream(browser.port);
    stream.say("GET /stream HTTP/1.1\r\nHost: " + browser.host + "\r\n" + browser.cookie + "\r\n");
    CHECK_THAT(stream.hear_until("\"objects\":\"objects.svg\"}"),
               Has("\"right\":true", "\"welcome.png\""));
    CHECK_THAT(browser.get("/choose.png", browser.cookie), Has("image/png"));
    CHECK_THAT(browser.get("/objects.svg", browser.cookie), Has("<svg"));
    CHECK_THAT(browser.get("/said.txt", browser.cookie), StartsWith("HTTP/1.1 404"));
    stream.forget();
    tests::write(file, tests::replaced(good, "rate_hz = 1000", "rate_hz = 1"));
    CHECK_THAT(stream.hear_until("\"objects\":null}"), Has("mine.toml:11:11: rate_hz is 1"));
    CHECK_THAT(browser.get("/choose.png", browser.cookie), StartsWith("HTTP/1.1 404"));
    preview.signal(SIGTERM);
    CHECK(preview.wait().code == 0);
}
