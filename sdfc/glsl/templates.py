"""Jinja's templates, compiled once: their bytecode is kept between runs."""

from __future__ import annotations

from jinja2.bccache import Bucket, BytecodeCache

from sdfc.cache import recall_bytes, remember_bytes

KIND = "templates-1"  # counts up with the environment's options, which Jinja does not look at


class KeptTemplates(BytecodeCache):
    """Jinja's own cache in a folder raises where nothing can be written; this does without."""

    def load_bytecode(self, bucket: Bucket) -> None:
        kept = recall_bytes(KIND, bucket.key)
        if kept is not None:
            try:
                bucket.bytecode_from_string(kept)
            except Exception:  # damaged in any way: a pickle raises anything. It is made and written again
                bucket.reset()

    def dump_bytecode(self, bucket: Bucket) -> None:
        remember_bytes(KIND, bucket.key, bucket.bytecode_to_string())
