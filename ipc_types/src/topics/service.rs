//! Request–response services.

use super::{Header, Message};
use crate::messages::optimiser::{PlanRequest, PlanResponse, TrajectorySample};
use crate::messages::world::ShapePoint;
use crate::transport::ExchangePorts;

/// A request–response service: header and slice both ways.
pub trait Service: Send + Sync + 'static {
    /// Name of the service.
    const NAME: &'static str;
    /// Event by which a client wakes the server after a request; the id is the client's index, and ignored.
    const ASKED: &'static str;
    /// Event by which the server wakes a client after its answer; the id is the client's index (the source in the
    /// request's stamp).
    const ANSWERED: &'static str;
    /// User header of requests.
    type RequestHeader: Header;
    /// Element of requests.
    type RequestElement: Message;
    /// User header of responses.
    type ResponseHeader: Header;
    /// Element of responses.
    type ResponseElement: Message;

    /// Its ports between processes.
    fn ports() -> &'static PortsOf<Self>;
}

/// The ports of a service.
pub type PortsOf<S> = ExchangePorts<
    <S as Service>::RequestHeader,
    <S as Service>::RequestElement,
    <S as Service>::ResponseHeader,
    <S as Service>::ResponseElement,
>;

/// Minimum-time planning: navigator ↔ optimiser.
#[derive(Debug, Clone, Copy)]
pub struct OptimiserPlan;

impl Service for OptimiserPlan {
    const NAME: &'static str = "optimiser/plan";
    const ASKED: &'static str = "optimiser/asked";
    const ANSWERED: &'static str = "optimiser/answered";
    type RequestHeader = PlanRequest;
    type RequestElement = ShapePoint;
    type ResponseHeader = PlanResponse;
    type ResponseElement = TrajectorySample;

    fn ports() -> &'static PortsOf<Self> {
        static PORTS: PortsOf<OptimiserPlan> = ExchangePorts::new();
        &PORTS
    }
}
