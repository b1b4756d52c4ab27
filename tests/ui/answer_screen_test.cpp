#include "ui/subject/paragraph.hpp"
#include "tests/support/catch.hpp"
#include "tests/ui/keys.hpp"

using namespace palpate::protocols;
using namespace palpate::ui;

namespace {

/// Somebody who does one thing and then another, the latter again and again until it was seen:
/// nobody knows how long a screen takes to appear.
class Insisting {
public:
    Insisting(std::function<void()> first, std::function<void()> then)
        : thread_([this, first = std::move(first), then = std::move(then)] {
              pause();
              first();
              for (pause(); !done_; pause()) {
                  then();
              }
          }) {}
    Insisting(const Insisting&) = delete;
    Insisting& operator=(const Insisting&) = delete;
    ~Insisting() {
        done_ = true;
        thread_.join();
    }

private:
    static void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(400)); }
    std::atomic<bool> done_{false};
    std::thread thread_;
};

struct Kind {
    ResponseKind kind;
    std::size_t answers;
};

constexpr Kind kKinds[] = {{ResponseKind::two_interval, 2},   {ResponseKind::yes_no, 2},
                           {ResponseKind::rating, 2},         {ResponseKind::rating, 9},
                           {ResponseKind::identification, 2}, {ResponseKind::identification, 9}};

}  // namespace

TEST_CASE("every answer of every kind is given by its key, by its card, and by arrows and Enter") {
    const Kind kind = GENERATE(from_range(std::begin(kKinds), std::end(kKinds)));
    const Question asked = question(kind.kind, kind.answers);
    SubjectScreen screen(options());
    const auto cards = lay_out_answers(asked, screen.stage().window().size());
    REQUIRE(cards.size() == kind.answers);
    const std::size_t wanted = kind.answers - 1;
    {
        const Later subject([&] {
            press(SDLK_1 + static_cast<int>(kind.answers));  // one too many
            press(SDLK_SPACE);
            press(SDLK_1 + static_cast<int>(wanted));
        });
        const Choice choice = screen.choose(kTrial, asked);
        CHECK(choice.place == wanted);
        CHECK(choice.input == InputKind::key);
        CHECK_FALSE(choice.confidence);
        CHECK((choice.reaction_s > 0.0 && choice.reaction_s < 5.0));
        CHECK((choice.uncertainty_s >= 0.0 && choice.uncertainty_s < 1.0));
    }
    {
        const Later subject([&] {
            click({3.0, 3.0});
            click(cards[wanted].centre());
        });
        const Choice choice = screen.choose(kTrial, asked);
        CHECK(choice.place == wanted);
        CHECK(choice.input == InputKind::mouse);
    }
    {
        const Later subject([&] {
            press(SDLK_RETURN);  // nothing is marked yet
            press(SDLK_RIGHT);
            for (int i = 0; i < 12; ++i) {
                press(SDLK_RIGHT);
            }
            press(SDLK_LEFT);
            press(SDLK_RETURN);
        });
        const Choice choice = screen.choose(kTrial, asked);
        CHECK(choice.place == wanted - 1);
        CHECK(choice.input == InputKind::arrows);
    }
    {
        const Later subject([] {
            press(SDLK_LEFT);
            press(SDLK_KP_ENTER);
        });
        CHECK(screen.choose(kTrial, asked).place == wanted);
    }
}

TEST_CASE("confidence is asked after the answer, on its own clock, and only where asked for") {
    SubjectScreen screen(options());
    for (int sure = 1; sure <= kMaxConfidence; ++sure) {
        const Insisting subject([] { press(SDLK_2); },
                                [sure] {
                                    press(SDLK_5);  // no such level
                                    press(SDLK_1 + sure - 1);
                                });
        const Choice choice = screen.choose(kTrial, question(ResponseKind::two_interval, 2, true));
        CHECK(choice.place == 1);
        REQUIRE(choice.confidence);
        CHECK(*choice.confidence == sure);
        CHECK(choice.confidence_reaction_s > 0.05);
        CHECK(choice.confidence_reaction_s < 5.0);
    }
}

TEST_CASE("the key that answers does not say how sure one is as well") {
    SubjectScreen screen(options());
    const Insisting subject(
        [] {
            press(SDLK_1);
            press(SDLK_1, KMOD_NONE, true);  // held down a little long
        },
        [] { press(SDLK_4); });
    CHECK(screen.choose(kTrial, question(ResponseKind::yes_no, 2, true)).confidence == 4);
}

TEST_CASE(
    "the experimenter can stop a session at the answer, at the confidence and at the feedback") {
    SubjectScreen screen(options());
    const auto stop = [] {
        press(SDLK_q, static_cast<SDL_Keymod>(KMOD_CTRL | KMOD_SHIFT));
        press(SDLK_y);
    };
    {
        const Later experimenter(stop);
        CHECK(screen.choose(kTrial, question(ResponseKind::rating, 7)).signal == Signal::abort);
    }
    {
        const Insisting subject([] { press(SDLK_1); }, stop);
        CHECK(screen.choose(kTrial, question(ResponseKind::rating, 7, true)).signal ==
              Signal::abort);
    }
    {
        stop();
        CHECK(screen.feedback(kTrial, true) == Signal::abort);
    }
    CHECK(screen.feedback(kTrial, false) == Signal::go_on);
}

TEST_CASE("wrapped text has every word in order, and no row is wider than asked for") {
    draw_into_memory();
    Window window({.font = {}, .instructions = {}});
    const std::string text = GENERATE(
        as<std::string>{}, "", "one", "Feel the object and say which of the pictures it was.",
        "Göremediğiniz nesneleri elinizle hissedeceksiniz.\n\nSonra  seçin.",
        "Donaudampfschifffahrtselektrizitätenhauptbetriebswerkbauunterbeamtengesellschaft üüüüüü");
    for (const double width : {60.0, 200.0, 700.0}) {
        const auto rows = wrapped(window, text, 20.0, width);
        std::string letters;
        for (const std::string& row : rows) {
            CHECK(window.text_width(row, 20.0) <= width);
            letters += row;
        }
        std::string wanted = text;
        const auto no_blanks = [](std::string& s) {
            std::erase_if(s, [](char c) { return c == ' ' || c == '\n'; });
        };
        no_blanks(letters);
        no_blanks(wanted);
        CHECK(letters == wanted);
    }
    CHECK(wrapped(window, "a\n\nb", 20.0, 500.0) == std::vector<std::string>{"a", "", "b"});
}

TEST_CASE("the longest instructions that a protocol may give fit their place on a small screen") {
    draw_into_memory();
    Window window({.width = 800, .height = 600, .font = {}, .instructions = {}});
    std::string words;
    while (words.size() < 590) {
        words += "nesneleri ";
    }
    const std::string lines = "1\n2\n3\n4\n5\n6\n7\n8";
    for (const std::string& text : {words, lines, std::string(600, 'W')}) {
        const double taken =
            write_into(window, text, {{64.0, 24.0}, {672.0, 120.0}}, 1.9 * 16.7, {255, 255, 255});
        CHECK(taken <= 120.0);
    }
}

using palpate::engine::Vec2;

TEST_CASE("cards lie side by side inside the window, all alike, for 2 to 9 pictures or answers") {
    const Vec2 size = GENERATE(Vec2{1024.0, 768.0}, Vec2{1280.0, 800.0}, Vec2{1920.0, 1080.0},
                               Vec2{800.0, 1200.0}, Vec2{800.0, 600.0}, Vec2{3840.0, 1080.0});
    struct Layout {
        std::function<std::vector<Card>(std::size_t)> of;
        double top, bottom, apart;  // the question is above
    };
    const auto answers = [&](ResponseKind kind) {
        return [&size, kind](std::size_t n) {
            return lay_out_answers(question(kind, n), size);
        };
    };
    for (const Layout& layout :
         {Layout{[&](std::size_t n) { return lay_out_cards(n, size); }, 0.2, 0.8, 0.0},
          Layout{answers(ResponseKind::rating), 0.25, 0.7, 2.0},
          Layout{answers(ResponseKind::two_interval), 0.25, 0.7, 2.0}}) {
        for (std::size_t n = 2; n <= 9; ++n) {
            CAPTURE(size.x, size.y, n);
            const std::vector<Card> cards = layout.of(n);
            REQUIRE(cards.size() == n);
            for (std::size_t i = 0; i < n; ++i) {
                CHECK(cards[i].corner.x > 0.0);
                CHECK(cards[i].corner.x + cards[i].size.x < size.x);
                CHECK(cards[i].corner.y > layout.top * size.y);
                CHECK(cards[i].corner.y + cards[i].size.y < layout.bottom * size.y);
                CHECK(cards[i].size == cards[0].size);
                CHECK((i == 0 || cards[i].corner.x >
                                     cards[i - 1].corner.x + cards[i - 1].size.x + layout.apart));
                CHECK(card_at(cards, cards[i].centre()) == i);
                CHECK_FALSE(card_at(cards, cards[i].corner - Vec2{2.0, 2.0}).has_value());
            }
        }
    }
}

TEST_CASE("a pixel goes to the object's frame and back, y up, the middle at (0, 30 mm)") {
    const PointerMap map{{1280.0, 800.0}};
    CHECK(map.to_object({640.0, 400.0}) == Vec2{0.0, 0.030});
    CHECK(map.to_object({644.0, 396.0}).x > 0.0);
    CHECK(map.to_object({644.0, 396.0}).y > 0.030);
    for (int i = 0; i < 100; ++i) {
        const Vec2 pixel{i * 12.8, i * 8.0};
        CHECK(glm::length(map.to_pixel(map.to_object(pixel)) - pixel) < 1e-9);
    }
}
