#include "ui/subject/stage.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "engine/realtime/servo.hpp"
#include "ui/sdl/sdl.hpp"
#include "ui/subject/display.hpp"

namespace palpate::ui {
namespace {

constexpr std::int64_t kStopQuestionNs = 3'000'000'000;

constexpr const char* kKeyboardElsewhere = "keyboard elsewhere";

/// The key that whoever pressed it means, on any keyboard layout: a letter by its place where the
/// layout has it nowhere, as Greek and Hebrew ones, whose Q writes a sign. (Digits that need Shift,
/// as on French layouts, SDL takes by their place itself.)
SDL_Keycode meant_by(const SDL_Keysym& key) {
    const SDL_Keycode letter = SDLK_a + (key.scancode - SDL_SCANCODE_A);
    const bool is_letter = key.scancode >= SDL_SCANCODE_A && key.scancode <= SDL_SCANCODE_Z;
    return is_letter && SDL_GetScancodeFromKey(letter) == SDL_SCANCODE_UNKNOWN ? letter : key.sym;
}

std::string marked_text(const Words& words, const protocols::MarkReply& reply) {
    if (!reply.found) {
        return std::string(words.nothing_to_mark);
    }
    return fmt::format(fmt::runtime(reply.number.practice ? words.practice_marked : words.marked),
                       reply.number.number, reply.number.total) +
           fmt::format(" {}", reply.runs_again ? words.runs_again : words.not_again);
}

/// 1 to 9 of either row of keys; 0: another key.
int digit_of(std::int32_t symbol) {
    return symbol >= SDLK_1 && symbol <= SDLK_9       ? symbol - SDLK_0
         : symbol >= SDLK_KP_1 && symbol <= SDLK_KP_9 ? symbol - SDLK_KP_1 + 1
                                                      : 0;
}

}  // namespace

Stage::Stage(StageOptions options)
    : options_(std::move(options)), window_(options_.window), looked_ns_(monotonic_ns()) {
    SDL_PumpEvents();
    SDL_FlushEvent(
        SDL_WINDOWEVENT);  // of the window that SDL made first, and hid, for its renderer
}

std::int64_t Stage::show(std::string_view name, std::function<void(Window&)> drawing) {
    face_ = std::move(drawing);
    redraw();
    const std::int64_t shown = monotonic_ns();
    if (!display_lost()) {
        window_.name_screen(name);
    }
    return shown;
}

std::string Stage::sentence_of(Bar bar) const {
    constexpr std::array<std::string_view Words::*, 8> kSentences{nullptr,
                                                                  &Words::stop_question,
                                                                  &Words::mark_last_question,
                                                                  nullptr,
                                                                  &Words::pause_comes,
                                                                  &Words::no_pause,
                                                                  &Words::session_over,
                                                                  &Words::keyboard_elsewhere};
    const Words& words = window_.words();
    if (bar == Bar::marked) {
        return marked_text(words, reply_);
    }
    const auto sentence = bar == Bar::mark && in_trial_ ? &Words::mark_question
                                                        : kSentences[static_cast<std::size_t>(bar)];
    return sentence == nullptr ? std::string() : std::string(words.*sentence);
}

/// What became of a mark, once the session says so.
void Stage::show_reply() {
    if (options_.desk == nullptr || bar_ == Bar::stop || bar_ == Bar::mark) {
        return;
    }
    if (const auto reply = options_.desk->take_reply()) {
        reply_ = *reply;
        show_bar(Bar::marked);
    }
}

void Stage::redraw() {
    if (display_lost()) {
        return;
    }
    window_.clear(kBackground);
    if (face_) {
        face_(window_);
    }
    if (!options_.watermark.empty()) {
        draw_watermark(window_, options_.watermark);
    }
    if (bar_ != Bar::none) {
        draw_bar(window_, sentence_of(bar_));
    }
    window_.present();
}

void Stage::stop(engine::Trip cause, const char* way) const {
    if (options_.on_stop) {
        options_.on_stop(cause, way);
    }
}

bool Stage::forget_earlier() {
    if (display_lost()) {
        return false;
    }
    SDL_PumpEvents();
    bool released = false;
    SDL_Event event;
    while (SDL_PeepEvents(&event, 1, SDL_GETEVENT, SDL_KEYDOWN, SDL_KEYUP) > 0) {
        const SDL_Keycode symbol = event.key.keysym.sym;
        released |= event.type == SDL_KEYUP && symbol == SDLK_SPACE;
        if (event.type == SDL_KEYDOWN && symbol == SDLK_ESCAPE && event.key.repeat == 0) {
            stop(engine::Trip::stopped, protocols::kEscapeAtScreen);
        }
    }
    SDL_FlushEvents(SDL_MOUSEBUTTONDOWN, SDL_MOUSEBUTTONUP);
    looked_ns_ = monotonic_ns();
    return released;
}

void Stage::guard_until(std::int64_t ns) {
    guarded_ns_ = ns;
    early_ = 0;
}

bool Stage::too_early(const Input& input) {
    using enum Input::Kind;
    const bool answers = input.kind == go || input.kind == enter || input.kind == digit ||
                         input.kind == left || input.kind == right || input.kind == click;
    const auto late_ns = static_cast<std::int64_t>(input.uncertainty_s * 1e9);
    const bool early = answers && input.seen_ns - late_ns < guarded_ns_;
    early_ += early ? 1 : 0;
    return early;
}

void Stage::show_bar(Bar bar) {
    bar_ = bar;
    bar_until_ns_ = monotonic_ns() + kStopQuestionNs;
    redraw();
}

void Stage::need_keyboard(bool needed) {
    needs_keyboard_ = needed;
    if (!needed) {
        static_cast<void>(keyboard_was_lost());  // of screens before
        if (bar_ == Bar::elsewhere) {
            drop_bar();
        }
    }
}

void Stage::mind_keyboard() {
    const bool elsewhere = needs_keyboard_ && keyboard_is_elsewhere();
    if (elsewhere && (bar_ == Bar::none || bar_ == Bar::elsewhere)) {
        const bool shown = bar_ == Bar::elsewhere;
        bar_ = Bar::elsewhere;
        bar_until_ns_ = monotonic_ns() + kStopQuestionNs;
        shown ? static_cast<void>(0) : redraw();
    } else if (!elsewhere && bar_ == Bar::elsewhere) {
        drop_bar();
        redraw();
    }
}

Input Stage::answer_question(std::int32_t symbol) {
    const Bar asked = std::exchange(bar_, Bar::none);
    redraw();
    if (symbol == SDLK_ESCAPE) {
        return {.kind = Input::Kind::stop};
    }
    if (symbol == SDLK_y && asked == Bar::mark) {
        options_.desk->mark();
    }
    return {.kind =
                symbol == SDLK_y && asked == Bar::stop ? Input::Kind::abort : Input::Kind::none};
}

/// Chords that no participant presses by accident. Whether it was one.
bool Stage::chord(std::int32_t symbol, std::uint16_t modifiers) {
    if ((modifiers & KMOD_CTRL) == 0 || (modifiers & KMOD_SHIFT) == 0) {
        return false;
    }
    if (symbol == SDLK_q) {
        show_bar(Bar::stop);
    } else if (desk_closed_ && (symbol == SDLK_m || symbol == SDLK_p)) {
        show_bar(Bar::over);
    } else if (symbol == SDLK_m && options_.desk != nullptr) {
        show_bar(Bar::mark);
    } else if (symbol == SDLK_p && options_.desk != nullptr) {
        options_.desk->pause();
        show_bar(options_.desk->wants_pause() ? Bar::pause_comes : Bar::no_pause);
    } else {
        return false;
    }
    return true;
}

Input Stage::key(std::int32_t symbol, std::uint16_t modifiers, bool repeat) {
    if (repeat) {  // held since an earlier screen, or too long: not a press
        return {};
    }
    const bool modifier_alone = symbol >= SDLK_LCTRL && symbol <= SDLK_RGUI;
    if ((bar_ == Bar::stop || bar_ == Bar::mark) && !modifier_alone) {
        return answer_question(symbol);
    }
    if (chord(symbol, modifiers)) {
        return {};
    }
    switch (symbol) {
        case SDLK_SPACE:
            return {.kind = Input::Kind::go};
        case SDLK_RETURN:
        case SDLK_KP_ENTER:
            return {.kind = Input::Kind::enter};
        case SDLK_ESCAPE:
            return {.kind = Input::Kind::stop};
        case SDLK_LEFT:
            return {.kind = Input::Kind::left};
        case SDLK_RIGHT:
            return {.kind = Input::Kind::right};
        default:
            break;
    }
    const int digit = digit_of(symbol);
    return digit == 0 ? Input{} : Input{.kind = Input::Kind::digit, .digit = digit};
}

Input Stage::read(const SDL_Event& event) {
    if (event.type == SDL_KEYDOWN) {
        return key(meant_by(event.key.keysym), event.key.keysym.mod, event.key.repeat != 0);
    }
    if (event.type == SDL_KEYUP && event.key.keysym.sym == SDLK_SPACE) {
        return {.kind = Input::Kind::release};
    }
    if (event.type == SDL_MOUSEBUTTONDOWN && event.button.button == SDL_BUTTON_LEFT) {
        if (needs_keyboard_ && keyboard_is_elsewhere()) {
            window_.take_keyboard();
        }
        return {.kind = Input::Kind::click, .pixel = pixel(event.button.x, event.button.y)};
    }
    if (event.type == SDL_MOUSEMOTION) {
        return {.kind = Input::Kind::motion, .pixel = pixel(event.motion.x, event.motion.y)};
    }
    if (event.type == SDL_QUIT) {
        if (options_.on_close) {
            options_.on_close();
        }
        return {.kind = Input::Kind::lost, .way = "window to be closed"};
    }
    return event.type == SDL_WINDOWEVENT ? read_window(event) : Input{};
}

Input Stage::read_window(const SDL_Event& event) {
    switch (event.window.event) {
        case SDL_WINDOWEVENT_FOCUS_LOST:
            return {.kind = Input::Kind::lost, .way = kKeyboardElsewhere};
        case SDL_WINDOWEVENT_HIDDEN:
        case SDL_WINDOWEVENT_MINIMIZED:
            return {.kind = Input::Kind::lost, .way = "window hidden"};
        case SDL_WINDOWEVENT_EXPOSED:
        case SDL_WINDOWEVENT_SIZE_CHANGED:
            redraw();
            break;
        default:
            break;
    }
    return {};
}

Input Stage::next(int wait_ms) {
    const std::int64_t until = monotonic_ns() + static_cast<std::int64_t>(wait_ms) * 1'000'000;
    for (;;) {
        if (display_lost() || (options_.interrupted && options_.interrupted())) {
            return {.kind = Input::Kind::abort};
        }
        window_.mind_frame();
        if (needs_keyboard_) {
            mind_keyboard();
        }
        show_reply();
        if (bar_ != Bar::none && monotonic_ns() > bar_until_ns_) {
            bar_ = Bar::none;
            redraw();
        }
        if (!needs_keyboard_ && keyboard_was_lost()) {
            return {.kind = Input::Kind::lost, .way = kKeyboardElsewhere};
        }
        SDL_Event event;
        // Rounded up: with 0 for the last part of a millisecond this would spin through it.
        const std::int64_t left_ms = (until - monotonic_ns() + 999'999) / 1'000'000;
        if (SDL_WaitEventTimeout(&event,
                                 static_cast<int>(std::clamp<std::int64_t>(left_ms, 0, 20))) == 0) {
            looked_ns_ = monotonic_ns();
            if (looked_ns_ >= until) {
                return {};
            }
            continue;
        }
        // What SDL makes of it, as the key that it lets go then, comes after the cause.
        const bool lost = !needs_keyboard_ && keyboard_was_lost();
        Input input = read(event);
        if (lost && input.kind != Input::Kind::stop && input.kind != Input::Kind::abort) {
            input = {.kind = Input::Kind::lost, .way = kKeyboardElsewhere};
        }
        const bool begins = input.kind == Input::Kind::go || input.kind == Input::Kind::enter;
        if (begins && needs_keyboard_ && keyboard_is_elsewhere()) {
            continue;
        }
        if (input.kind == Input::Kind::stop) {
            stop(engine::Trip::stopped, protocols::kEscapeAtScreen);
        }
        if (input.kind != Input::Kind::none) {
            input.seen_ns = monotonic_ns();
            input.uncertainty_s =
                std::max(0.0, static_cast<double>(input.seen_ns - looked_ns_) * 1e-9);
            if (!too_early(input)) {
                return input;
            }
        }
    }
}

bool Stage::wait_or_abort(double seconds) {
    const std::int64_t until = monotonic_ns() + static_cast<std::int64_t>(seconds * 1e9);
    while (monotonic_ns() < until) {
        if (next(5).kind == Input::Kind::abort) {
            return true;
        }
    }
    return false;
}

bool Stage::pause_or_abort() {
    constexpr int kWaitMs = 50;
    drop_bar();  // it has come
    show(PauseFace{});
    while (options_.desk != nullptr && !options_.desk->wants_stop() &&
           !options_.desk->take_pause()) {
        if (next(kWaitMs).kind == Input::Kind::abort) {
            return true;
        }
    }
    drop_bar();
    return false;
}

engine::Vec2 Stage::pixel(int x, int y) const {
    return window_.scale() * engine::Vec2{x, y};
}

}  // namespace palpate::ui
