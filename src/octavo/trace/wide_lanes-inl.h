// SPDX-License-Identifier: MIT
//
// Operations on some lanes of a vector: what Highway has no name for, or takes two instructions
// for where one will do. Compiled once for each SIMD target.
#if defined(OCTAVO_TRACE_WIDE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef OCTAVO_TRACE_WIDE_LANES_INL_H
#undef OCTAVO_TRACE_WIDE_LANES_INL_H
#else
#define OCTAVO_TRACE_WIDE_LANES_INL_H
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <span>

#undef OCTAVO_WIDE_AVX512
#define OCTAVO_WIDE_AVX512 (HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL)

HWY_BEFORE_NAMESPACE();
namespace octavo::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using Floats = hn::Vec<FloatTag>;
using Ints = hn::Vec<IntTag>;
using FloatMask = hn::Mask<FloatTag>;
using IntMask = hn::Mask<IntTag>;
constexpr std::size_t kLanes = HWY_LANES(float);
constexpr std::uint64_t kLaneBits = (std::uint64_t{1} << kLanes) - 1;

/// `a`, but where the mask is set a + b.
HWY_INLINE Ints add_where(IntMask mask, Ints a, Ints b) {
#if OCTAVO_WIDE_AVX512
    return Ints{_mm512_mask_add_epi32(a.raw, mask.raw, a.raw, b.raw)};
#else
    return hn::Add(a, hn::IfThenElseZero(mask, b));
#endif
}

/// `a`, but where the mask is set a - b.
HWY_INLINE Ints subtract_where(IntMask mask, Ints a, Ints b) {
#if OCTAVO_WIDE_AVX512
    return Ints{_mm512_mask_sub_epi32(a.raw, mask.raw, a.raw, b.raw)};
#else
    return hn::Sub(a, hn::IfThenElseZero(mask, b));
#endif
}

/// `a`, but where the mask is set a ^ b.
HWY_INLINE Ints xor_where(IntMask mask, Ints a, Ints b) {
#if OCTAVO_WIDE_AVX512
    return Ints{_mm512_mask_xor_epi32(a.raw, mask.raw, a.raw, b.raw)};
#else
    return hn::Xor(a, hn::IfThenElseZero(mask, b));
#endif
}

/// `other`, but where the mask is set a & b.
HWY_INLINE Ints and_where(IntMask mask, Ints other, Ints a, Ints b) {
#if OCTAVO_WIDE_AVX512
    return Ints{_mm512_mask_and_epi32(other.raw, mask.raw, a.raw, b.raw)};
#else
    return hn::IfThenElse(mask, hn::And(a, b), other);
#endif
}

/// Whether some bit is set in both.
HWY_INLINE IntMask has_any(Ints a, Ints b) {
#if OCTAVO_WIDE_AVX512
    return IntMask{_mm512_test_epi32_mask(a.raw, b.raw)};
#else
    return hn::Ne(hn::And(a, b), hn::Zero(IntTag()));
#endif
}

/// Where the mask is set, whether some bit is set in both.
HWY_INLINE IntMask has_any_where(IntMask mask, Ints a, Ints b) {
#if OCTAVO_WIDE_AVX512
    return IntMask{_mm512_mask_test_epi32_mask(mask.raw, a.raw, b.raw)};
#else
    return hn::And(mask, has_any(a, b));
#endif
}

/// Where the mask is set, whether a >= b.
HWY_INLINE IntMask at_least_where(IntMask mask, Ints a, Ints b) {
#if OCTAVO_WIDE_AVX512
    return IntMask{_mm512_mask_cmp_epi32_mask(mask.raw, a.raw, b.raw, _MM_CMPINT_NLT)};
#else
    return hn::AndNot(hn::Lt(a, b), mask);
#endif
}

/// Where the mask is set, whether a < b.
HWY_INLINE IntMask less_where(IntMask mask, Floats a, Floats b) {
#if OCTAVO_WIDE_AVX512
    return IntMask{_mm512_mask_cmp_ps_mask(mask.raw, a.raw, b.raw, _CMP_LT_OQ)};
#else
    return hn::And(mask, hn::RebindMask(IntTag(), hn::Lt(a, b)));
#endif
}

/// `other`, but where the mask is set words[at]. Elsewhere `at` is not used.
HWY_INLINE Ints gather_where(IntMask mask, Ints other, const std::int32_t* words, Ints at) {
#if OCTAVO_WIDE_AVX512
    return Ints{_mm512_mask_i32gather_epi32(other.raw, mask.raw, at.raw, words, 4)};
#else
    const Ints some = hn::GatherIndex(IntTag(), words, hn::IfThenElseZero(mask, at));
    return hn::IfThenElse(mask, some, other);
#endif
}

/// Number of the highest bit of 0 < a < 2^24: a float's exponent.
HWY_INLINE Ints highest_bit(Ints a) {
    const IntTag di;
    return hn::Sub(hn::ShiftRight<23>(hn::BitCast(di, hn::ConvertTo(FloatTag(), a))),
                   hn::Set(di, 127));
}

/// Set bits of numbers below 128.
HWY_INLINE Ints count_bits(Ints bytes) {
    const IntTag di;
#if OCTAVO_WIDE_AVX512
    const __m512i counts =
        _mm512_broadcast_i32x4(_mm_setr_epi8(0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4));
    // A shuffle looks at the low four bits, and at the highest.
    const __m512i high = hn::ShiftRight<4>(bytes).raw;
    return hn::Add(Ints{_mm512_shuffle_epi8(counts, bytes.raw)},
                   Ints{_mm512_shuffle_epi8(counts, high)});
#else
    Ints v = hn::Sub(bytes, hn::And(hn::ShiftRight<1>(bytes), hn::Set(di, 0x55)));
    v = hn::Add(hn::And(v, hn::Set(di, 0x33)), hn::And(hn::ShiftRight<2>(v), hn::Set(di, 0x33)));
    return hn::And(hn::Add(v, hn::ShiftRight<4>(v)), hn::Set(di, 15));
#endif
}

/// Asks for these to be brought into the cache.
template <class T>
HWY_INLINE void prefetch(std::span<T> some) {
    constexpr std::size_t kLine = 64;
    const char* const begin = reinterpret_cast<const char*>(some.data());
    for (std::size_t at = 0; at < some.size_bytes(); at += kLine) hwy::Prefetch(begin + at);
}

}  // namespace octavo::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
