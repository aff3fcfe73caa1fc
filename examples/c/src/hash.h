/* FNV-1a over the bits of numbers: 64 bits, low byte first. */
#ifndef HASH_H
#define HASH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct hash {
    uint64_t value;
};

struct hash hash_new(void);
void hash_bits(struct hash *hash, uint32_t bits);
void hash_number(struct hash *hash, float number);
void hash_numbers(struct hash *hash, const float *numbers, size_t count);

/* Writes the line `name hash`. */
void hash_line(const char *name, const struct hash *hash);

#ifdef __cplusplus
}
#endif

#endif
