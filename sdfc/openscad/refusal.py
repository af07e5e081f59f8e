"""What has no exact form here."""


class RefusalError(Exception):
    """Raised where only the geometry is known; the evaluator adds the place and makes it a SceneError."""

    def __init__(self, message: str, hint: str | None = None) -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint
