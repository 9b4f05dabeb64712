"""The Protocol Buffers language: from the text of a `.proto` file, or from descriptors, to the meta-model.

    text ─ syntax ─▶ tree ─ reading ─▶ File ─────┐
                                                 ├─ files ─▶ symbols ─▶ checks ─▶ schema
    descriptors ────────────────────────────────▶┘

Both ways meet in `tree.File`, so that names are resolved, rules are checked and types are built in one way only.
"""
