"""``meshonet models``."""

from meshonet_cli import options as o

EXAMPLES = ("meshonet models", "meshonet models --json")


def models(as_json: o.AsJson = False, debug: o.Debug = False) -> int:
    """List the operators that are shipped."""
    from meshonet.api.models import models as described
    from meshonet_cli.report.models import model_text
    from meshonet_cli.session import Session

    session = Session(as_json=as_json, debug=debug)
    for facts in described():
        if as_json:
            session.result(facts)
        else:
            session.print(model_text(facts))
    return session.finish()
