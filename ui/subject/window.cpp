#include "ui/subject/window.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>
#include <png.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "ui/sdl/sdl.hpp"
#include "ui/subject/display.hpp"
#include "ui/subject/font.hpp"

namespace palpate::ui {
namespace {

struct Delete {
    void operator()(SDL_Window* window) const { SDL_DestroyWindow(window); }
    void operator()(SDL_Renderer* renderer) const { SDL_DestroyRenderer(renderer); }
    void operator()(SDL_Surface* surface) const { SDL_FreeSurface(surface); }
    void operator()(SDL_Texture* texture) const { SDL_DestroyTexture(texture); }
    void operator()(TTF_Font* font) const { TTF_CloseFont(font); }
};

template <class T>
using Own = std::unique_ptr<T, Delete>;

template <class T>
T* checked(T* made, std::string_view what) {
    refuse_if<std::runtime_error>(
        made == nullptr, "{} failed: {}; without a display use --headless", what, SDL_GetError());
    return made;
}

/// Smallest window that suits the faces, units of the display.
constexpr int kWidth = 1280;
constexpr int kHeight = 800;

/// SDL counts from 0.
int index_of(const WindowOptions& options) {
    return std::max(options.monitor - 1, 0);
}

/// What panels leave of the monitor.
SDL_Rect usable_bounds(int monitor) {
    SDL_Rect usable{0, 0, kWidth, kHeight};
    if (SDL_GetDisplayUsableBounds(monitor, &usable) != 0) {
        SDL_GetDisplayBounds(monitor, &usable);
    }
    return usable;
}

/// Where the window stands, units of the display: all of its monitor, or three quarters in its
/// middle, but not less than the faces want, and not more than there is.
SDL_Rect place_of(const WindowOptions& options) {
    SDL_Rect whole{0, 0, kWidth, kHeight};
    if (options.fullscreen) {
        SDL_GetDisplayBounds(index_of(options), &whole);
        return whole;
    }
    const SDL_Rect usable = usable_bounds(index_of(options));
    const int width =
        options.width > 0 ? options.width : std::min(usable.w, std::max(kWidth, 3 * usable.w / 4));
    const int height = options.height > 0 ? options.height
                                          : std::min(usable.h, std::max(kHeight, 3 * usable.h / 4));
    return {usable.x + std::max(0, (usable.w - width) / 2),
            usable.y + std::max(0, (usable.h - height) / 2), width, height};
}

/// Takes in what hangs out of its monitor with its title bar and frame.
/// @return they are there
bool keep_inside(SDL_Window* window, int monitor) {
    int top = 0;
    int left = 0;
    int bottom = 0;
    int right = 0;
    if (SDL_GetWindowBordersSize(window, &top, &left, &bottom, &right) != 0 ||
        top + left + bottom + right == 0) {
        return false;
    }
    const SDL_Rect usable = usable_bounds(monitor);
    SDL_Rect is{};
    SDL_GetWindowPosition(window, &is.x, &is.y);
    SDL_GetWindowSize(window, &is.w, &is.h);
    SDL_Rect fits = is;
    fits.w = std::min(is.w, usable.w - left - right);
    fits.h = std::min(is.h, usable.h - top - bottom);
    fits.x = std::clamp(is.x, usable.x + left, usable.x + usable.w - right - fits.w);
    fits.y = std::clamp(is.y, usable.y + top, usable.y + usable.h - bottom - fits.h);
    if (SDL_RectEquals(&is, &fits) == SDL_FALSE) {
        SDL_SetWindowSize(window, fits.w, fits.h);
        SDL_SetWindowPosition(window, fits.x, fits.y);
    }
    return true;
}

SDL_Renderer* renderer_of(SDL_Window* window) {
    SDL_Renderer* renderer = SDL_CreateRenderer(window, -1, 0);
    return renderer != nullptr ? renderer : SDL_CreateRenderer(window, -1, SDL_RENDERER_SOFTWARE);
}

/// To be drawn on; null: the renderer has none.
Own<SDL_Texture> canvas(SDL_Renderer* renderer, int width, int height) {
    SDL_Texture* made = SDL_CreateTexture(renderer, SDL_PIXELFORMAT_RGBA32,
                                          SDL_TEXTUREACCESS_TARGET, width, height);
    if (made != nullptr) {
        SDL_SetTextureScaleMode(made, SDL_ScaleModeLinear);
    }
    return Own<SDL_Texture>(made);
}

}  // namespace

struct Window::Parts {
    Own<SDL_Window> window;
    Own<SDL_Renderer> renderer;
    std::string font_file;
    std::map<int, Own<TTF_Font>> fonts;  ///< by height in pixels
    std::optional<int> unframed_on{};    ///< the monitor of a window that has no frame yet
    bool software = false;               ///< the renderer rounds corners to whole pixels
    engine::Vec2 origin{};               ///< of what is being drawn finely, pixels
    double scale = 1.0;

    TTF_Font* font(double height) {
        const int points = std::max(8, static_cast<int>(std::lround(height)));
        Own<TTF_Font>& font = fonts[points];
        if (!font) {
            font.reset(
                checked(TTF_OpenFont(font_file.c_str(), points), "opening the font " + font_file));
        }
        return font.get();
    }
    void forget() {
        static_cast<void>(renderer.release());
        static_cast<void>(window.release());
    }
    [[nodiscard]] Own<SDL_Surface> snapshot() const {
        int width = 0;
        int height = 0;
        SDL_GetRendererOutputSize(renderer.get(), &width, &height);
        Own<SDL_Surface> surface(
            SDL_CreateRGBSurfaceWithFormat(0, width, height, 32, SDL_PIXELFORMAT_RGBA32));
        if (SDL_RenderReadPixels(renderer.get(), nullptr, SDL_PIXELFORMAT_RGBA32, surface->pixels,
                                 surface->pitch) != 0) {
            throw std::runtime_error(
                fmt::format("reading the window's pixels failed: {}", SDL_GetError()));
        }
        return surface;
    }
};

Window::Window(const WindowOptions& options)
    : parts_(std::make_unique<Parts>()),
      words_(&words_in(options.language)),
      language_(options.language),
      instructions_(options.instructions) {
    parts_->font_file = find_font(options.font);
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_VIDEO_X11_NET_WM_BYPASS_COMPOSITOR, "0");
    if (!open_display() || TTF_Init() != 0) {
        throw std::runtime_error(
            fmt::format("no window can be opened: {}; use --headless", SDL_GetError()));
    }
    const SDL_Rect place = place_of(options);
    // Without a window manager nobody makes the window as large as the screen: it already is.
    const int whole =
        options.fullscreen ? SDL_WINDOW_FULLSCREEN_DESKTOP | SDL_WINDOW_BORDERLESS : 0;
    parts_->window.reset(
        checked(SDL_CreateWindow("palpate", place.x, place.y, place.w, place.h,
                                 static_cast<Uint32>(SDL_WINDOW_SHOWN | SDL_WINDOW_RESIZABLE |
                                                     SDL_WINDOW_ALLOW_HIGHDPI | whole)),
                "opening the window"));
    if (!options.fullscreen && options.width == 0) {
        parts_->unframed_on = index_of(options);
    }
    SDL_Renderer* renderer = checked(renderer_of(parts_->window.get()), "drawing into the window");
    parts_->renderer.reset(renderer);
    watch_display(parts_->window.get());  // SDL may have made it anew for its renderer
    SDL_SetRenderDrawBlendMode(renderer, SDL_BLENDMODE_BLEND);
    SDL_RendererInfo info{};
    SDL_GetRendererInfo(renderer, &info);
    parts_->software = (info.flags & static_cast<Uint32>(SDL_RENDERER_SOFTWARE)) != 0;
}

Window::~Window() {
    if (display_lost()) {  // SDL would ask the server for what went with it
        parts_->forget();
        return;
    }
    SDL_ShowCursor(SDL_ENABLE);
    parts_.reset();
    TTF_Quit();
    SDL_Quit();
}

engine::Vec2 Window::size() const {
    int width = 0;
    int height = 0;
    SDL_GetRendererOutputSize(parts_->renderer.get(), &width, &height);
    return {static_cast<double>(width), static_cast<double>(height)};
}

double Window::scale() const {
    int width = 0;
    SDL_GetWindowSize(parts_->window.get(), &width, nullptr);
    return width > 0 ? size().x / width : 1.0;
}

void Window::clear(Colour colour) {
    written_.clear();
    SDL_SetRenderDrawColor(parts_->renderer.get(), colour.r, colour.g, colour.b, 255);
    SDL_RenderClear(parts_->renderer.get());
}

void Window::triangles(std::span<const Corner> corners, Colour colour) {
    std::vector<SDL_Vertex> vertices;
    vertices.reserve(corners.size());
    for (const Corner& corner : corners) {
        const auto alpha = static_cast<Uint8>(std::lround(255.0F * corner.cover));
        const engine::Vec2 p = (corner.position - parts_->origin) * parts_->scale;
        vertices.push_back({{static_cast<float>(p.x), static_cast<float>(p.y)},
                            {colour.r, colour.g, colour.b, alpha},
                            {0.0F, 0.0F}});
    }
    SDL_RenderGeometry(parts_->renderer.get(), nullptr, vertices.data(),
                       static_cast<int>(vertices.size()), nullptr, 0);
}

void Window::fine(const engine::Vec2& corner,
                  const engine::Vec2& extent,
                  const std::function<void()>& shapes) {
    constexpr int kFiner = 4;
    SDL_Renderer* renderer = parts_->renderer.get();
    const SDL_Rect where{
        static_cast<int>(std::lround(corner.x)), static_cast<int>(std::lround(corner.y)),
        static_cast<int>(std::lround(extent.x)), static_cast<int>(std::lround(extent.y))};
    const auto texture = [&](int scale) {
        return parts_->software ? canvas(renderer, scale * where.w, scale * where.h) : nullptr;
    };
    const Own<SDL_Texture> large = texture(kFiner);
    const Own<SDL_Texture> half = texture(kFiner / 2);
    if (!large || !half) {
        shapes();
        return;
    }
    // What the shapes leave out keeps the window's picture, copied in first.
    const Own<SDL_Surface> behind(
        SDL_CreateRGBSurfaceWithFormat(0, where.w, where.h, 32, SDL_PIXELFORMAT_RGBA32));
    SDL_RenderReadPixels(renderer, &where, SDL_PIXELFORMAT_RGBA32, behind->pixels, behind->pitch);
    const Own<SDL_Texture> below(SDL_CreateTextureFromSurface(renderer, behind.get()));
    SDL_SetRenderTarget(renderer, large.get());
    SDL_RenderCopy(renderer, below.get(), nullptr, nullptr);
    parts_->origin = {static_cast<double>(where.x), static_cast<double>(where.y)};
    parts_->scale = kFiner;
    shapes();
    parts_->origin = {0.0, 0.0};
    parts_->scale = 1.0;
    // Two halvings, each the mean of 2 x 2 pixels.
    SDL_SetRenderTarget(renderer, half.get());
    SDL_RenderCopy(renderer, large.get(), nullptr, nullptr);
    SDL_SetRenderTarget(renderer, nullptr);
    SDL_RenderCopy(renderer, half.get(), nullptr, &where);
}

void Window::text(
    std::string_view line, const engine::Vec2& at, double height, Colour colour, Align align) {
    if (line.empty()) {
        return;
    }
    const Own<SDL_Surface> surface(
        TTF_RenderUTF8_Blended(parts_->font(height), std::string(line).c_str(),
                               SDL_Color{colour.r, colour.g, colour.b, 255}));
    const Own<SDL_Texture> texture(SDL_CreateTextureFromSurface(
        parts_->renderer.get(), checked(surface.get(), "drawing text")));
    const double share = align == Align::left ? 0.0 : align == Align::centre ? 0.5 : 1.0;
    const SDL_Rect where{static_cast<int>(std::lround(at.x - share * surface->w)),
                         static_cast<int>(std::lround(at.y - 0.5 * surface->h)), surface->w,
                         surface->h};
    SDL_RenderCopy(parts_->renderer.get(), texture.get(), nullptr, &where);
    written_.push_back({std::string(line),
                        {static_cast<double>(where.x), static_cast<double>(where.y)},
                        {static_cast<double>(where.w), static_cast<double>(where.h)}});
}

double Window::text_width(std::string_view line, double height) {
    int width = 0;
    TTF_SizeUTF8(parts_->font(height), std::string(line).c_str(), &width, nullptr);
    return width;
}

void Window::mind_frame() {
    if (parts_->unframed_on && keep_inside(parts_->window.get(), *parts_->unframed_on)) {
        parts_->unframed_on.reset();
    }
}

void Window::present() {
    SDL_RenderPresent(parts_->renderer.get());
}

void Window::name_screen(std::string_view name) {
    SDL_SetWindowTitle(parts_->window.get(), fmt::format("palpate: {}", name).c_str());
}

void Window::take_keyboard() {
    SDL_RaiseWindow(parts_->window.get());
    SDL_SetWindowInputFocus(parts_->window.get());
}

void Window::show_pointer(bool shown) {
    if (display_lost()) {
        return;
    }
    SDL_ShowCursor(shown ? SDL_ENABLE : SDL_DISABLE);
}

void Window::put_pointer(const engine::Vec2& pixel) {
    if (display_lost()) {
        return;
    }
    SDL_PumpEvents();
    SDL_FlushEvent(SDL_MOUSEMOTION);
    const engine::Vec2 place = pixel / scale();
    SDL_WarpMouseInWindow(parts_->window.get(), static_cast<int>(place.x),
                          static_cast<int>(place.y));
}

std::vector<std::uint8_t> Window::pixels() const {
    const Own<SDL_Surface> surface = parts_->snapshot();
    const auto* bytes = static_cast<const std::uint8_t*>(surface->pixels);
    return {bytes, bytes + static_cast<std::ptrdiff_t>(surface->pitch) * surface->h};
}

void Window::save_png(const std::string& file) const {
    const Own<SDL_Surface> surface = parts_->snapshot();
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(surface->w);
    image.height = static_cast<png_uint_32>(surface->h);
    image.format = PNG_FORMAT_RGBA;
    std::string bytes;
    for (const bool counted : {false, true}) {
        png_alloc_size_t size = bytes.size();
        refuse_if<std::runtime_error>(
            png_image_write_to_memory(&image, counted ? bytes.data() : nullptr, &size, 0,
                                      surface->pixels, surface->pitch, nullptr) == 0,
            "{} cannot be written: {}", file, image.message);
        bytes.resize(size);
    }
    write_whole(file, bytes);
}

}  // namespace palpate::ui
