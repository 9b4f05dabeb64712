from typing import Any

class TranslationUnitLoadError(Exception): ...

class Index:
    @staticmethod
    def create(excludeDecls: bool = False) -> Any: ...
