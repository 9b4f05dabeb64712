"""Threads share what they should not: `KINDS` are functions that let them, by what is shared."""

from tests.api.sharing import of_batches as of_batches
from tests.api.sharing import of_holders as of_holders
from tests.api.sharing.turns import CHOICES as CHOICES
from tests.api.sharing.turns import KINDS as KINDS
