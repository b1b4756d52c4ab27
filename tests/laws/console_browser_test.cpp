#include "tests/support/console.hpp"
#include "tests/support/dev_tools.hpp"

namespace {

std::string address_in(const std::string& out) {
    return "http://" + behind(out, "http://");
}

}  // namespace

TEST_CASE("a browser shows the session, and what is pressed there is in the file", "[console]") {
    if (!DevTools::installed()) {
        return;
    }
    ShownSession session;
    const Console console(session);
    DevTools page(address_in(console.program.out()));
    REQUIRE(page.is("participant", "P1"));
    CHECK(page.value("location.href") == "http://" + console.browser->host + "/");
    CHECK(page.text("kind") == "SIMULATED");
    CHECK(eventually([&] {
        return page.text("sentence").find(session.state()["sentence"].get<std::string>()) == 0;
    }));
    CHECK(eventually([&] {
        const data::Json state = session.state();
        const auto answered = state["answered"].get<int>();
        const auto left = state["remaining"].get<int>();
        return page.text("left") ==
               fmt::format("{} of {} answered, {} remain", answered, answered + left, left);
    }));

    CHECK(page.text("pause-word") == "Pause");
    page.press("pause");
    REQUIRE(session.comes_to("pause"));
    CHECK(session.keeps(events_of("pause"), "1"));
    CHECK(page.is("pause-word", "Go on"));
    page.press("note");
    page.type("they hum \u2014 twice");
    page.press("note-send");
    CAPTURE(page.text("said"), page.value("document.activeElement.id"),
            page.value("document.getElementById('note').value"));
    CHECK(
        session.keeps("SELECT text FROM event WHERE event_kind = 'note'", "they hum \u2014 twice"));
    CHECK(page.shows("notes", "they hum \u2014 twice"));
    page.press("pause");
    CHECK(session.keeps(events_of("go on"), "1"));
    CHECK(page.is("pause-word", "Pause"));
    REQUIRE(eventually([&] { return page.text("sentence").find("exploring") == 0; }));
    page.press("mark");
    REQUIRE(
        eventually([&] { return page.value("document.getElementById('ask').open") == "true"; }));
    CHECK_THAT(page.text("ask-text"), Has(" is kept") && !Has("running or last"));
    page.press("ask-stop");
    CHECK(session.keeps(events_of("stop"), "1"));
    CHECK(session.kept(events_of("mark")) == "0");
    CHECK(page.value("performance.getEntriesByType('resource').every(one => "
                     "one.name.startsWith(location.origin))") == "true");

    session.program.signal(SIGSTOP);
    CHECK(page.shows("alerts", "The session does not answer."));
    CHECK(page.text("force-word") == "Force not known");
    page.press("stop");
    CHECK(page.shows("said", "the switch of its motors"));
    session.program.signal(SIGCONT);
    CHECK(page.is("force-word", "Force off"));
    session.program.signal(SIGKILL);
    CHECK(page.shows("alerts", "The session is gone."));
    CHECK(page.value("document.getElementById('pause').getAttribute('aria-disabled')") == "true");
}

TEST_CASE("of two browsers one shows what is felt, and both go on with the next server",
          "[console]") {
    if (!DevTools::installed()) {
        return;
    }
    ShownSession session("shape_friction", {"2", "--console"});
    REQUIRE(session.program.says("\nCtrl+C"));
    const std::string address = address_in(session.program.out());
    DevTools one(address);
    DevTools other(address);
    REQUIRE((one.is("participant", "P1") && other.is("participant", "P1")));
    const std::string covers = "document.getElementById('shown').hidden";
    one.press("reveal");
    REQUIRE(eventually([&] { return one.value("document.getElementById('ask').open") == "true"; }));
    one.press("ask-yes");
    CHECK(session.keeps(events_of("reveal"), "1"));
    CHECK(eventually([&] { return one.value(covers) == "false"; }));

    kill(console_of(session.program.id()), SIGKILL);
    REQUIRE(session.program.warns("is started again"));
    other.press("pause");
    REQUIRE(session.comes_to("pause"));
    for (DevTools* page : {&one, &other}) {
        CHECK(page->is("pause-word", "Go on"));
        CHECK(page->text("alerts").empty());
    }
    CHECK(one.value(covers) == "false");
    CHECK(other.value(covers) == "true");
    const pid_t server = console_of(session.program.id());
    REQUIRE(server > 0);
    CHECK(session.program.ended_by(SIGTERM) == 3);
    for (DevTools* page : {&one, &other}) {
        CHECK(page->shows("link", "page rests"));
    }
    CHECK(eventually([&] { return has_ended(server); }));
}

TEST_CASE("a page behind another knows the state, one that hears nothing switches the force off",
          "[console][safety]") {
    if (!DevTools::installed()) {
        return;
    }
    ShownSession session;
    const Console console(session);
    DevTools page(address_in(console.program.out()));
    const auto titled = [&](const std::string& phase) {
        return eventually(
            [&] { return page.value("document.title").find(phase) != std::string::npos; });
    };
    const auto hide = [&](const std::string& hidden) {
        page.run("(Object.defineProperty(document, 'hidden', {value: " + hidden +
                 ", configurable: true}), document.dispatchEvent(new Event('visibilitychange')))");
    };
    REQUIRE(page.is("participant", "P1"));
    hide("true");
    CHECK(session.ask({{"do", "pause"}})["ok"] == true);
    CHECK(titled("pause"));
    page.run("new BroadcastChannel('palpate').postMessage('')");  // of one that is looked at
    CHECK(titled("see the other page"));
    hide("false");
    CHECK(session.ask({{"do", "go on"}})["ok"] == true);
    CHECK(titled("explore"));
    CHECK(page.text("alerts").empty());

    console.program.signal(SIGSTOP);
    REQUIRE(titled("LOST"));
    page.press("stop");
    console.program.signal(SIGCONT);
    CHECK(session.keeps(events_of("stop"), "1"));
    CHECK(page.is("alerts", ""));

    page.run("location.reload()");
    REQUIRE(page.is("participant", "P1"));
    CHECK(session.program.ended_by(SIGTERM) == 3);
    page.run("location.reload()");
    CHECK(page.shows("alerts", "ended early"));
    CHECK(page.shows("link", "page rests"));
    page.press("note");
    page.type("too late");
    page.run("document.getElementById('note-form').requestSubmit()");
    CHECK(page.text("said") == "the session has ended");
    CHECK(session.kept(events_of("note")) == "0");
}
