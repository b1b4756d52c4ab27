#include <deque>
#include <mutex>

#include "ui/console/page_server.hpp"
#include "ui/rig/json_line.hpp"
#include "tests/support/dev_tools.hpp"

// The experimenter's page as it lies in its files: what it is made of, and told of every state that
// a session can be in.

using data::Json;

namespace {

/// A session in which something is felt; what differs from it in other states, what the page then
/// says at the elements of some ids, and which buttons it bars.
const Json kTold = Json::parse(test_text("console_states.json"));

const Words kAll{"stop", "pause", "mark", "end", "note-send"};

/// Whatever somebody could not read: what is wider than its place, what the page is too narrow for,
/// buttons that cover each other, and a contrast below 4.5.
const std::string kUnreadable = test_text("scripts/unreadable.js");

std::string page_file(const std::string& name) {
    return slurp(PALPATE_SOURCE_DIR "/ui/console/page/console." + name);
}

/// What stands between `open` and `close`, everywhere in a text.
std::set<std::string> all_after(const std::string& text,
                                const std::string& open,
                                const std::string& close) {
    const Words all = between(text, open, close);
    return {all.begin(), all.end()};
}

/// The page in a browser, and a server that tells it what it is told here, once.
class ToldPage {
public:
    /// With what differs from the session in which something is felt.
    void tells(const Json& differs) {
        Json now = kTold["exploring"];
        now.merge_patch(differs);
        const std::scoped_lock lock(mutex_);
        event_ = ui::event_text("state", now);
    }
    /// Tells it, and waits until it is shown.
    [[nodiscard]] bool heard(Json differs) {
        differs["number"] = ++number_;
        tells(differs);
        return page.is("number", fmt::format("session {}", number_));
    }
    /// What was asked for, in order. The next that is asked for takes what `answers` begins with.
    [[nodiscard]] std::vector<Json> asked() {
        const std::scoped_lock lock(mutex_);
        return asked_;
    }
    void answers(std::deque<Json> with) {
        const std::scoped_lock lock(mutex_);
        answers_ = std::move(with);
    }

private:
    [[nodiscard]] ui::PageServerSpec spec() {
        ui::PageServerSpec spec;
        spec.file = [](std::string_view path) {
            return page_file(path == "/" ? "html" : path == "/console.js" ? "js" : "css");
        };
        spec.open = [this](bool /*shown*/, bool /*still*/) {
            return [this, said = std::string()]() mutable -> std::optional<std::string> {
                const std::scoped_lock lock(mutex_);
                return std::exchange(said, event_) == event_ ? "event: live\ndata: {}\n\n" : event_;
            };
        };
        spec.act = [this](const std::string& line, bool /*gone*/) {
            const std::scoped_lock lock(mutex_);
            asked_.push_back(Json::parse(line));
            Json answer{{"ok", true}, {"text", "done"}};
            if (!answers_.empty()) {
                answer = answers_.front();
                answers_.pop_front();
            }
            return answer.dump();
        };
        return spec;
    }

    std::mutex mutex_;
    std::string event_;
    std::vector<Json> asked_;
    std::deque<Json> answers_;
    int number_ = 0;
    const ui::PageServer server_{spec()};

public:
    DevTools page{server_.address()};
};

}  // namespace

TEST_CASE("in every state the page says what is, bars what cannot be asked, and can be read",
          "[console]") {
    if (!DevTools::installed()) {
        return;
    }
    ToldPage told;
    DevTools& page = told.page;
    for (const Json& state : kTold["states"]) {
        CAPTURE(state["differs"].dump());
        told.tells({});
        page.run("(window.before = 1, location.reload())");
        REQUIRE(eventually([&] { return page.value("window.before") == "undefined"; }));
        REQUIRE(told.heard(state["differs"]));
        for (const auto& says : state["says"].get<std::vector<Words>>()) {
            const std::string shown = page.text(says[0]);
            CAPTURE(says, shown);
            CHECK_THAT(shown, Has(says[1]));
            CHECK((!says[1].empty() || shown.empty()));
        }
        for (const std::string& id : kAll) {
            CAPTURE(id);
            CHECK((page.value("document.getElementById('" + id + "').ariaDisabled") == "true") ==
                  (std::ranges::count(state["barred"], Json(id)) > 0));
        }
        for (const int width : {390, 844, 1120, 3840}) {
            for (const bool dark : {false, true}) {
                page.looks(width, dark);
                CAPTURE(width, dark);
                CHECK(page.value(kUnreadable) == "");
            }
        }
    }
}

TEST_CASE("on a blind page what runs on by itself is written anew every 5 s, and at each step",
          "[console]") {
    if (!DevTools::installed()) {
        return;
    }
    ToldPage told;
    DevTools& page = told.page;
    REQUIRE(told.heard({}));
    page.run(
        "(window.writes = 0, new MutationObserver(all => { "
        "if (all.some(one => one.target.id !== 'number')) ++window.writes; }).observe("
        "document.body, {subtree: true, childList: true, characterData: true, attributes: "
        "true}))");
    const Json late = kTold["exploring"]["late"];
    for (int i = 1; i <= 30; ++i) {
        Json more = late;
        more["session"][0] = more["session"][0].get<int>() + 1000 * i;
        REQUIRE(told.heard({{"phase_s", 4.1 + i}, {"saved_ms", 40 + 9 * i}, {"late", more}}));
    }
    CHECK(page.value("window.writes < 10") == "true");
    CHECK(page.text("seconds") != "");
    REQUIRE(told.heard({{"phase", "question"}, {"phase_s", 61.0}}));
    CHECK(page.text("seconds") == ", 1 min 1 s");
    REQUIRE(told.heard({{"phase", "question"}, {"phase_s", 61.2}, {"pausing", true}}));
    CHECK(page.text("seconds") == ", 1 min 1 s, then a pause");
}

TEST_CASE("a session that does not answer is seen to be old, and nothing covers that",
          "[console]") {
    if (!DevTools::installed()) {
        return;
    }
    ToldPage told;
    DevTools& page = told.page;
    const auto opacity = [&] {
        return page.value("getComputedStyle(document.getElementById('scene')).opacity");
    };
    REQUIRE(told.heard({}));
    CHECK(opacity() == "1");
    page.press("mark");
    REQUIRE(
        eventually([&] { return page.value("document.getElementById('ask').open") == "true"; }));
    REQUIRE(told.heard({{"silent_s", 4.0}}));
    CHECK(page.value("document.getElementById('ask').open") == "false");
    CHECK(opacity() == "0.4");
    CHECK(told.asked().empty());
    told.answers({{{"ok", false}, {"text", "nobody heard it"}}});
    page.press("stop");
    REQUIRE(page.is("said", "nobody heard it"));
    REQUIRE(told.heard({{"silent_s", nullptr}}));
    CHECK(page.text("said").empty());
    CHECK(opacity() == "1");
}

TEST_CASE("who asks to see what is felt, and whose word another page took, asks again",
          "[console]") {
    if (!DevTools::installed()) {
        return;
    }
    ToldPage told;
    DevTools& page = told.page;
    REQUIRE(told.heard({}));
    told.answers({{{"ok", false}, {"word", "one"}}, {{"ok", false}, {"word", "two"}}});
    page.press("reveal");
    page.press("ask-yes");
    REQUIRE(eventually([&] { return told.asked().size() == 3; }));
    CHECK(told.asked()[2] == Json{{"do", "reveal"}, {"word", "two"}});
    CHECK(page.is("said", "done"));
}

TEST_CASE("the experimenter's page is of its own origin alone, and its script finds what it fills",
          "[console]") {
    const std::string html = page_file("html");
    const std::string script = page_file("js");
    const std::string style = page_file("css");
    for (const std::string& text : {html, script, style}) {
        REQUIRE_FALSE(text.empty());
        CHECK_THAT(text, HasNone("http:", "https:", "//www", "@import", "url(", "data:"));
    }
    CHECK_THAT(html, HasNone("<script>", "<style", " style=", " onclick", " onload"));
    for (const char* of_text : {"innerHTML", "outerHTML", "insertAdjacentHTML", "document.write",
                                "eval("}) {  // names and notes are text, never markup
        CAPTURE(of_text);
        CHECK_THAT(script, !Has(of_text));
    }
    const std::set<std::string> ids = all_after(html, " id=\"", "\"");
    const std::set<std::string> used = all_after(script, "$('", "'");
    CHECK(used.size() > 40);
    for (const std::string& id : used) {
        CAPTURE(id);
        CHECK(ids.contains(id));
    }
    for (const char* of : {" for=\"", " aria-labelledby=\""}) {
        for (const std::string& id : all_after(html, of, "\"")) {
            CAPTURE(id);
            CHECK(ids.contains(id));
        }
    }
    // Only what is in the contract is asked for.
    CHECK(all_after(script, "{ do: '", "'") ==
          std::set<std::string>{"end", "mark", "note", "reveal", "stop"});
}
