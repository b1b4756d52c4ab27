#include "ui/console/page_server.hpp"
#include "tests/support/console.hpp"

// Several pages of one session, servers that die or stand still, and another user of the machine.
// Nothing is asserted about time.

namespace {

const std::string kNoted = R"({"do":"note","text":"once"})";

std::string word_in(const std::string& answer) {
    return behind(answer, "\"word\":\"", "\"");
}

/// Whether a file that may be read has the text.
bool says(const std::filesystem::path& file, const std::string& text) {
    std::ifstream in(file, std::ios::binary);
    std::string all(1U << 20U, '\0');
    in.read(all.data(), static_cast<std::streamsize>(all.size()));
    return all.find(text) != std::string::npos;
}

}  // namespace

TEST_CASE("what two pages ask for at once is done once, and what one shows the other does not",
          "[console][safety]") {
    ShownSession session;
    const Console one(session);
    const Console other(session);
    one.browser->trade();
    other.browser->trade();
    CHECK(one.browser->cookie == other.browser->cookie);
    const auto blind = other.stream();
    const auto both = [&](const std::string& first, const std::string& second) {
        std::array<std::string, 2> said;
        std::thread beside([&] { said[1] = other.browser->act(second); });
        said[0] = one.browser->act(first);
        beside.join();
        return said;
    };
    for (int i = 0; i < 5; ++i) {
        const std::string end = std::to_string(i) + "\"}";
        static_cast<void>(
            both(R"({"do":"note","text":"a)" + end, R"({"do":"note","text":"b)" + end));
    }
    CHECK(session.kept("SELECT count(*) || ' ' || count(DISTINCT text) FROM event WHERE event_kind "
                       "= 'note'") == "10 10");
    const std::string pause = R"({"do":"pause"})";
    static_cast<void>(both(pause, pause));
    REQUIRE(session.comes_to("pause"));
    const std::string go_on = R"({"do":"go on"})";
    static_cast<void>(both(go_on, go_on));
    CHECK(session.keeps(events_of("go on"), "1"));
    CHECK(session.kept(events_of("pause")) == "1");
    REQUIRE(session.comes_to("explore"));
    static_cast<void>(both(R"({"do":"mark","reason":"a sneeze"})", R"({"do":"mark"})"));
    CHECK(session.keeps("SELECT count(*) FROM trial WHERE invalid_reason LIKE '%: a sneeze'", "1"));
    CHECK(session.kept(events_of("mark")) == "1");

    const std::string word = word_in(one.browser->act(R"({"do":"reveal"})"));
    CHECK_THAT(one.browser->act(R"({"do":"reveal","word":")" + word + "\"}"), Has("\"ok\":true"));
    CHECK_THAT(one.stream("?shown=1")->hear_until("\"hidden\":"), Has("\"reveal\":\"shown\""));
    CHECK(eventually([&] {
        return one.stream("?shown=1")->hear_until("\"hip\":", 1).find("\"hip\":") !=
               std::string::npos;
    }));
    const std::string heard = blind->hear_until("\"reveal\":\"shown\"", 2);
    CHECK_THAT(heard, Has("\"reveal\":\"ask\"") && Has("event: live"));
    CHECK_THAT(heard, HasNone("hidden", "convex", "concave", "correct", "\"hip\"", "strips"));
    const std::string again = other.browser->act(R"({"do":"reveal"})");
    CHECK_THAT(again, Has("\"ok\":true"));
    CHECK(word_in(again).empty());
    CHECK(session.kept(events_of("reveal")) == "1");

    const auto asked = both(R"({"do":"end"})", R"({"do":"end"})");
    const std::string end = R"({"do":"end","word":")" + word_in(asked[0]) + "\"}";
    CHECK(word_in(asked[0]) == word_in(asked[1]));
    const auto ended = both(end, end);
    CHECK((ended[0] + ended[1]).find("what was recorded is kept") != std::string::npos);
    CHECK(word_in(ended[0] + ended[1]).empty());  // nor is the other one asked again
    CHECK(session.program.wait().code == 3);
}

TEST_CASE("a page that dies is started again once, at its address, and the session goes on",
          "[console]") {
    ShownSession session(kFourTrials, {"1", "--console"});
    const auto die = [&] {
        const pid_t console = console_of(session.program.id());
        REQUIRE(console > 0);
        kill(console, SIGKILL);
        CHECK(eventually([&] { return kill(console, 0) != 0; }));  // or it takes one more request
    };
    CHECK(session.ask({{"do", "pause"}})["ok"] == true);
    REQUIRE(session.comes_to("pause"));
    const Browser browser = browser_of(session.program);
    CHECK_THAT(session.program.out(), Has("\nCtrl+C at the session's terminal ends the session"));
    const auto serves = [&] {
        CHECK_THAT(browser.get("/", browser.cookie).substr(0, 2000), Has("HTTP/1.1 200"));
    };
    serves();
    die();
    serves();  // whoever comes meanwhile waits for the next one
    CHECK_THAT(session.program.error(), Has("ended, and is started again"));
    CHECK(session.state()["phase"] == "pause");
    die();
    CHECK(eventually([&] {
        return session.program.error().find("ended again; palpate console " + session.shown.uuid) !=
               std::string::npos;
    }));
    CHECK(console_of(session.program.id()) == 0);
    {
        Console ends(session);
        CHECK(ends.program.ended_by(SIGTERM) == 0);
    }
    const Console by_hand(session);
    CHECK(by_hand.browser->host == browser.host);
    CHECK(by_hand.browser->token == browser.token);
    serves();
    by_hand.program.signal(SIGSTOP);
    const Console beside(session);
    serves();  // of two that listen, the one that lives
    CHECK(session.ask({{"do", "go on"}})["ok"] == true);
    CHECK(session.program.wait().code == 0);
    CHECK(session.kept("SELECT count(*) FROM response") == "4");
}

TEST_CASE("who waits at an address before its server is there is answered as others are",
          "[console]") {
    std::atomic<int> answered = 0;
    const auto serve = [&] {
        for (int i = 0; i < 40; ++i) {
            ui::PageServerSpec spec;
            spec.token = spec.cookie = std::string(32, 'a');
            spec.listening = ui::listening_at(htonl(INADDR_LOOPBACK));
            sockaddr_in at{};
            socklen_t length = sizeof at;
            getsockname(spec.listening.get(), reinterpret_cast<sockaddr*>(&at), &length);
            const std::uint16_t port = ntohs(at.sin_port);
            HttpLine waits(port);
            waits.say(fmt::format("GET /?token={} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n",
                                  spec.token, port));
            const ui::PageServer server(std::move(spec));
            answered += waits.hear_until("\r\n\r\n").starts_with("HTTP/1.1 303") ? 1 : 0;
        }
    };
    std::vector<std::thread> many;  // else no server is made to wait while it is asked
    for (int i = 0; i < 8; ++i) {
        many.emplace_back(serve);
    }
    for (std::thread& one : many) {
        one.join();
    }
    CHECK(answered == 320);
}

TEST_CASE("a page of a session that is over asks nothing of the next one on its file",
          "[console][safety]") {
    ShownSession session;
    const Console before(session);
    before.browser->trade();
    CHECK(session.program.ended_by(SIGTERM) == 3);
    for (int i = 0; i < 2; ++i) {  // loaded again
        CHECK_THAT(before.stream()->hear_until("\r\n0\r\n\r\n"),
                   Has("\"alive\":false", "\"ended\":\"ended early\""));
    }
    Process next({palpate_program(), "run", "shape_friction", "--participant", "P1", "--db",
                  session.file, "--headless", "--operator", "Ada", "--secret", kRunSecret,
                  "--speed", "2"});
    REQUIRE(eventually([&] { return !ui::running_sessions(session.file).empty(); }));
    for (const std::string& what : {kNoted, std::string(R"({"do":"stop"})")}) {
        CHECK_THAT(before.browser->act(what), Has("is gone: nothing was done"));
    }
    const Console after(session);
    CHECK_THAT(after.browser->get("/", before.browser->cookie), StartsWith("HTTP/1.1 403"));
    after.browser->trade();
    CHECK_THAT(after.browser->act(kNoted), Has("\"ok\":true"));
    CHECK(next.ended_by(SIGTERM) == 3);
    CHECK(session.kept(events_of("note")) == "1");
    CHECK(session.kept(events_of("stop")) == "0");
}

TEST_CASE("a server that stood still does nothing late but switch the force off, and ends",
          "[console][safety]") {
    ShownSession session("shape_friction", {"2", "--console"});
    const Browser browser = browser_of(session.program);
    const pid_t console = console_of(session.program.id());
    REQUIRE(console > 0);
    kill(console, SIGSTOP);
    for (const std::string& what : {kNoted, std::string(R"({"do":"stop"})"), kNoted}) {
        const HttpLine gone(browser.port);
        gone.say("POST /do HTTP/1.1\r\nHost: " + browser.host + "\r\n" + browser.cookie +
                 browser.origin() + "Content-Type: application/json\r\nContent-Length: " +
                 std::to_string(what.size()) + "\r\n\r\n" + what);
    }
    kill(console, SIGCONT);
    CHECK(session.keeps(events_of("stop"), "1"));
    CHECK_THAT(browser.act(kNoted), Has("\"ok\":true"));
    kill(console, SIGSTOP);
    CHECK(session.program.ended_by(SIGTERM) == 3);
    CHECK(session.kept(events_of("note")) == "1");
    CHECK(eventually([&] { return has_ended(console); }));
}

TEST_CASE("another user of the machine finds neither the page's token nor another way to it",
          "[console][safety]") {
    ShownSession session("shape_friction", {"2", "--console"});
    const Browser browser = browser_of(session.program);
    const std::string cookie = browser.cookie.substr(browser.cookie.find('=') + 1, 32);
    const pid_t console = console_of(session.program.id());
    std::vector<std::filesystem::path> files;
    for (const pid_t process : {session.program.id(), console}) {
        const std::string folder = "/proc/" + std::to_string(process);
        for (const char* part : {"", "/fd", "/map_files"}) {
            for (const auto& entry : std::filesystem::directory_iterator(folder + part)) {
                files.push_back(entry.path());
            }
        }
    }
    const auto asked = [&](const std::string& line) {
        return ui::ask_session(session.shown.name, line).line;
    };
    CHECK(asked(R"({"do":"page"})").find(browser.token) != std::string::npos);
    CHECK(holds_for_a_stranger([&] {
        bool found = false;
        for (const auto& file : files) {
            found |= says(file, browser.token) || says(file, cookie);
        }
        const std::string zeros(32, '0');
        const std::string guess = "Cookie: palpate_" + std::to_string(browser.port) + "=" + zeros;
        const auto refused = [](const std::string& answer) {
            return answer.starts_with("HTTP/1.1 403") &&
                   answer.find("\"ok\":true") == std::string::npos;
        };
        return !found && asked(R"({"do":"page"})").empty() && asked(R"({"do":"state"})").empty() &&
               refused(browser.get("/")) && refused(browser.get("/?token=" + zeros)) &&
               refused(browser.get("/stream?shown=1")) &&
               refused(browser.get("/stream", guess + "\r\n")) &&
               refused(browser.act(kNoted, browser.origin())) &&
               refused(browser.act(kNoted, guess + "\r\n" + browser.origin()));
    }));
    CHECK(session.kept(events_of("note")) == "0");
    CHECK_THAT(browser.act(kNoted), Has("\"ok\":true"));
    CHECK(session.program.ended_by(SIGTERM) == 3);
}
