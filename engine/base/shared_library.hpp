#pragma once

#include <string>

#include <dlfcn.h>

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

}  // namespace palpate
