#pragma once

#include <SDL2/SDL.h>
#include <SDL2/SDL_ttf.h>

#include "engine/base/shared_library.hpp"

/// SDL2 and SDL2_ttf, of which every file of this room calls what stands here. They bring fifty
/// libraries, and most commands open neither a window nor a font: loaded when the first does, and a
/// machine that only analyses needs none of them.
namespace palpate::ui {

struct Sdl {
    static constexpr const char* kFile = "libSDL2-2.0.so.0";
    static constexpr const char* kUse = "windows and sound need SDL2";
    static constexpr const char* kPackage = "libsdl2-2.0-0";
};

struct SdlTtf {
    static constexpr const char* kFile = "libSDL2_ttf-2.0.so.0";
    static constexpr const char* kUse = "texts on a screen need SDL2_ttf";
    static constexpr const char* kPackage = "libsdl2-ttf-2.0-0";
};

PALPATE_LATE(Sdl, SDL_CloseAudioDevice);
PALPATE_LATE(Sdl, SDL_CreateRGBSurfaceWithFormat);
PALPATE_LATE(Sdl, SDL_CreateRenderer);
PALPATE_LATE(Sdl, SDL_CreateTexture);
PALPATE_LATE(Sdl, SDL_CreateTextureFromSurface);
PALPATE_LATE(Sdl, SDL_CreateWindow);
PALPATE_LATE(Sdl, SDL_Delay);
PALPATE_LATE(Sdl, SDL_DestroyRenderer);
PALPATE_LATE(Sdl, SDL_DestroyTexture);
PALPATE_LATE(Sdl, SDL_DestroyWindow);
PALPATE_LATE(Sdl, SDL_EventState);
PALPATE_LATE(Sdl, SDL_FlushEvent);
PALPATE_LATE(Sdl, SDL_FlushEvents);
PALPATE_LATE(Sdl, SDL_FreeSurface);
PALPATE_LATE(Sdl, SDL_GetAudioDeviceStatus);
PALPATE_LATE(Sdl, SDL_GetCurrentAudioDriver);
PALPATE_LATE(Sdl, SDL_GetCurrentVideoDriver);
PALPATE_LATE(Sdl, SDL_GetDesktopDisplayMode);
PALPATE_LATE(Sdl, SDL_GetDisplayBounds);
PALPATE_LATE(Sdl, SDL_GetDisplayName);
PALPATE_LATE(Sdl, SDL_GetDisplayUsableBounds);
PALPATE_LATE(Sdl, SDL_GetError);
PALPATE_LATE(Sdl, SDL_GetKeyboardFocus);
PALPATE_LATE(Sdl, SDL_GetNumVideoDisplays);
PALPATE_LATE(Sdl, SDL_GetRendererInfo);
PALPATE_LATE(Sdl, SDL_GetRendererOutputSize);
PALPATE_LATE(Sdl, SDL_GetVersion);
PALPATE_LATE(Sdl, SDL_GetWindowBordersSize);
PALPATE_LATE(Sdl, SDL_GetWindowPosition);
PALPATE_LATE(Sdl, SDL_GetWindowSize);
PALPATE_LATE(Sdl, SDL_Init);
PALPATE_LATE(Sdl, SDL_InitSubSystem);
PALPATE_LATE(Sdl, SDL_OpenAudioDevice);
PALPATE_LATE(Sdl, SDL_PauseAudioDevice);
PALPATE_LATE(Sdl, SDL_PeepEvents);
PALPATE_LATE(Sdl, SDL_PumpEvents);
PALPATE_LATE(Sdl, SDL_Quit);
PALPATE_LATE(Sdl, SDL_QuitSubSystem);
PALPATE_LATE(Sdl, SDL_RaiseWindow);
PALPATE_LATE(Sdl, SDL_RenderClear);
PALPATE_LATE(Sdl, SDL_RenderCopy);
PALPATE_LATE(Sdl, SDL_RenderGeometry);
PALPATE_LATE(Sdl, SDL_RenderPresent);
PALPATE_LATE(Sdl, SDL_RenderReadPixels);
PALPATE_LATE(Sdl, SDL_SetEventFilter);
PALPATE_LATE(Sdl, SDL_SetHint);
PALPATE_LATE(Sdl, SDL_SetRenderDrawBlendMode);
PALPATE_LATE(Sdl, SDL_SetRenderDrawColor);
PALPATE_LATE(Sdl, SDL_SetRenderTarget);
PALPATE_LATE(Sdl, SDL_SetTextureScaleMode);
PALPATE_LATE(Sdl, SDL_SetWindowInputFocus);
PALPATE_LATE(Sdl, SDL_GetScancodeFromKey);
PALPATE_LATE(Sdl, SDL_SetWindowPosition);
PALPATE_LATE(Sdl, SDL_SetWindowSize);
PALPATE_LATE(Sdl, SDL_SetWindowTitle);
PALPATE_LATE(Sdl, SDL_ShowCursor);
PALPATE_LATE(Sdl, SDL_WaitEventTimeout);
PALPATE_LATE(Sdl, SDL_WarpMouseInWindow);
PALPATE_LATE(Sdl, SDL_WasInit);

PALPATE_LATE(SdlTtf, TTF_CloseFont);
PALPATE_LATE(SdlTtf, TTF_GlyphIsProvided32);
PALPATE_LATE(SdlTtf, TTF_Init);
PALPATE_LATE(SdlTtf, TTF_Linked_Version);
PALPATE_LATE(SdlTtf, TTF_OpenFont);
PALPATE_LATE(SdlTtf, TTF_Quit);
PALPATE_LATE(SdlTtf, TTF_RenderUTF8_Blended);
PALPATE_LATE(SdlTtf, TTF_SizeUTF8);

}  // namespace palpate::ui
