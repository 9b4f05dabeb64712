/* The field among those of a site that lacks bytes: each section is for other units. */

/* == indices == */
static size_t indices_in(const char *path)
{
    size_t found = 0;
    for (; *path != 0; path++) {
        found += path[0] == '{' && path[1] == '}' ? 1u : 0u;
    }
    return found;
}

/* == fields == */
/* The field among those of a site that lacks bytes, of which `available` are there. */
static void locate(${name}_error *error, const struct site *site, int64_t available)
{
    for (int number = 0; number < site->parts; number++) {
        const struct part *part = &site->part[number];
        if ((int64_t)part->offset + part->size > available) {
            error->path = part->path;
            error->offset += part->offset;
            return;
        }
    }
}

/* == elements == */
/* The field among those of a site that lacks bytes, of which `available` are there; a part with a step are the elements of an array. */
static void locate(${name}_error *error, const struct site *site, int64_t available)
{
    for (int number = 0; number < site->parts; number++) {
        const struct part *part = &site->part[number];
        int64_t element = 0;
        if (part->step != 0 && available - part->offset - part->size >= 0) {
            element = (available - part->offset - part->size) / part->step + 1;
        }
        if (part->step != 0 || (int64_t)part->offset + part->size > available) {
            const size_t indices = indices_in(part->path);
            error->path = part->path;
            error->offset += part->offset + element * part->step;
            if (part->step != 0 && indices > 0) {
                error->indices[indices - 1] = element;
            }
            return;
        }
    }
}
