#pragma once

#include <atomic>
#include <stdexcept>
#include <string>

#include <dlfcn.h>

#include "engine/base/refuse.hpp"

namespace palpate {

/// A library that is looked for when it is needed, and stays until the process ends: its threads
/// may outlive whoever loaded it.
class SharedLibrary {
public:
    /// @param name  a path, or a name where the system keeps libraries
    explicit SharedLibrary(const std::string& name)
        : handle_(dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL)) {}

    /// It was found, with all that it needs.
    [[nodiscard]] bool loaded() const noexcept { return handle_ != nullptr; }
    /// A function of it, whatever type its user gives it.
    struct Symbol {
        void* place = nullptr;  ///< null: there is none of this name

        template <class Function>
        operator Function*() const noexcept {  // NOLINT: the declaration names the type once
            return reinterpret_cast<Function*>(place);
        }
    };
    /// The symbol of this name; a null one if the library was not loaded or has none.
    [[nodiscard]] Symbol find(const char* name) const noexcept {
        return {loaded() ? dlsym(handle_, name) : nullptr};
    }

private:
    void* handle_;
};

/// A function of a library that is loaded when the first of its functions is needed; called as if
/// it had been linked. Any thread.
/// @tparam Library  kFile, kUse ("a window needs SDL2") and kPackage, what to install
template <class Library, class Function>
class LateFunction {
public:
    explicit constexpr LateFunction(const char* name) : name_(name) {}

    /// @throws std::runtime_error if the library is not installed: what to install
    operator Function*() const {  // NOLINT: a call of this object is a call of the function
        Function* function = function_.load(std::memory_order_acquire);
        if (function == nullptr) {
            static const SharedLibrary library(Library::kFile);
            function = library.find(name_);
            refuse_if<std::runtime_error>(function == nullptr,
                                          "{}: there is no {} with {} here; install {}",
                                          Library::kUse, Library::kFile, name_, Library::kPackage);
            function_.store(function, std::memory_order_release);
        }
        return function;
    }
    /// Somebody called it.
    [[nodiscard]] bool called() const noexcept { return function_.load() != nullptr; }

private:
    const char* name_;
    mutable std::atomic<Function*> function_{nullptr};
};

/// Declares it under the name that the library's header gives, in a namespace where it is found
/// before that.
#define PALPATE_LATE(library, name) \
    inline constinit const ::palpate::LateFunction<library, decltype(::name)> name(#name)

}  // namespace palpate
