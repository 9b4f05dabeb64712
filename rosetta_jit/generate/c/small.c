/* What freestanding units have instead of functions of `support.c`: a machine that reads no number where it is not aligned takes many instructions for one. */

/* == once == */
/* Where code is to be small, what takes many instructions is there once. */
#if defined(__OPTIMIZE_SIZE__) && defined(__GNUC__) && defined(__arm__) && !defined(__ARM_FEATURE_UNALIGNED)
#define ONCE __attribute__((noinline)) static
#else
#define ONCE static inline
#endif

/* == full | needs: failure == */
/* A lane lacks room. */
ONCE int64_t full(struct failure *failure, ptrdiff_t lane, int64_t missing)
{
    failure->site = 0;
    failure->offset = lane;
    failure->indices[0] = missing;
    return -1;
}

/* == load_u64_le | needs: load_u32_le == */
static inline uint64_t load_u64_le(const unsigned char *at)
{
    return load_u32_le(at) | (uint64_t)load_u32_le(at + 4) << 32;
}

/* == load_u64_be | needs: load_u32_be == */
static inline uint64_t load_u64_be(const unsigned char *at)
{
    return (uint64_t)load_u32_be(at) << 32 | load_u32_be(at + 4);
}

/* == load_f64_${order} | order: le be | needs: load_u64_${order} float64_of == */
ONCE double load_f64_${order}(const unsigned char *at)
{
    return float64_of(load_u64_${order}(at));
}

/* == store_u64_le | needs: store_u32_le == */
static inline void store_u64_le(unsigned char *at, uint64_t number)
{
    store_u32_le(at, (uint32_t)(number & 0xffffffffu));
    store_u32_le(at + 4, (uint32_t)(number >> 32));
}

/* == store_u64_be | needs: store_u32_be == */
static inline void store_u64_be(unsigned char *at, uint64_t number)
{
    store_u32_be(at, (uint32_t)(number >> 32));
    store_u32_be(at + 4, (uint32_t)(number & 0xffffffffu));
}

/* == store_f64_${order} | order: le be | needs: store_u64_${order} bits_of_f64 == */
ONCE void store_f64_${order}(unsigned char *at, double number)
{
    store_u64_${order}(at, bits_of_f64(number));
}
