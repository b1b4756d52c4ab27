#pragma once

/// Code for newer processors beside that for all, chosen as it runs. The bits are the same: AVX2
/// works on four numbers at once, each by the one operation of IEEE 754, and nothing is contracted
/// (-ffp-contract=off).
namespace palpate {

#if defined(__x86_64__)
/// This processor has AVX2, and BMI2, which shifts without moving the count.
[[nodiscard]] inline bool has_avx2() noexcept {
    return __builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("bmi2") != 0;
}
#else
[[nodiscard]] constexpr bool has_avx2() noexcept {
    return false;
}
#endif

/// What `work` does, with all that it calls in one piece: with AVX2 a tenth to a third fewer
/// instructions.
/// @param work  its call operator and what that calls are inline or of the same file
template <class Work>
[[gnu::noinline, gnu::flatten]] auto plainly(const Work& work) noexcept {
    return work();
}
#if defined(__x86_64__)
template <class Work>
[[gnu::noinline, gnu::flatten, gnu::target("avx2,bmi2")]] auto by_avx2(const Work& work) noexcept {
    return work();
}
#else
template <class Work>
auto by_avx2(const Work& work) noexcept {
    return work();
}
#endif
template <class Work>
auto as_this_processor_can(const Work& work) noexcept {
    return has_avx2() ? by_avx2(work) : plainly(work);
}

}  // namespace palpate
