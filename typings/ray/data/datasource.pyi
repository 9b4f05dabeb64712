from collections.abc import Callable, Iterable

import pyarrow as pa
from ray.data.block import BlockMetadata

class ReadTask:
    def __init__(
        self,
        read_fn: Callable[[], Iterable[pa.Table]],
        metadata: BlockMetadata,
        schema: pa.Schema | None = None,
        per_task_row_limit: int | None = None,
    ) -> None: ...
